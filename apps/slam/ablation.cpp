#include "apps/slam/ablation.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/base/quantile.h"
#include "slam/evaluation/alignment.h"
#include "slam/evaluation/ape.h"
#include "slam/evaluation/evaluation.h"
#include "slam/evaluation/loop_evaluation.h"
#include "slam/pipeline/recorder.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/prefetcher.h"
#include "slam/world/layouts.h"
#include "slam/world/office_sequence.h"
#include "slam/world/street_sequence.h"

namespace penumbra::apps {

namespace {

constexpr std::pair<const char*, MaskSource> kSources[] = {
    {"none", MaskSource::none},
    {"movers", MaskSource::movers},
    {"classes", MaskSource::classes},
    {"geometry", MaskSource::geometry},
    {"boxes", MaskSource::boxes},
    {"clusters-unrepaired", MaskSource::clusters_unrepaired},
    {"clusters", MaskSource::clusters},
    {"clusters-consistent", MaskSource::clusters_consistent},
    {"dbscan", MaskSource::dbscan},
    {"static-boxes", MaskSource::static_boxes},
    {"static-paper", MaskSource::static_paper},
    {"static-points", MaskSource::static_points},
    {"static-masks", MaskSource::static_masks},
    {"truth", MaskSource::truth}};

constexpr const char* kComplete = ".complete";  // marks a drive that was rendered to its end

bool uses_clusters(MaskSource source) {
  return source == MaskSource::clusters_unrepaired || source == MaskSource::clusters ||
         source == MaskSource::clusters_consistent;
}

bool gives_back(MaskSource source) {
  return source == MaskSource::static_boxes || source == MaskSource::static_paper ||
         source == MaskSource::static_points || source == MaskSource::static_masks;
}

bool is_by_dbscan(MaskSource source) {
  return source == MaskSource::dbscan || source == MaskSource::static_paper ||
         source == MaskSource::static_points;
}

slam::SlamSettings settings_of(const AblationCell& cell) {
  slam::SlamSettings settings;
  settings.deterministic = cell.run == 0;
  if (cell.all_frames) settings.semantics.mode = slam::SegmentationMode::all;
  settings.tracker.mismatch_filter.mode = slam::mismatch_filter_mode(cell.filter);
  settings.tracker.rigid_mover.enabled = settings.semantics.instances.companions.enabled =
      cell.masks != MaskSource::none;
  settings.semantics.instances.check_motion =
      cell.masks == MaskSource::geometry || (cell.masks == MaskSource::truth && !cell.is_office());
  slam::DepthMaskSettings& depth = settings.semantics.depth_masks;
  depth.consistency.enabled = cell.masks == MaskSource::clusters_consistent;
  if (cell.masks == MaskSource::clusters_unrepaired) depth.repair.mode = slam::RepairMode::off;
  if (cell.masks == MaskSource::boxes || cell.masks == MaskSource::static_boxes) {
    depth.masks = slam::InstanceMasks::boxes;
  } else if (uses_clusters(cell.masks)) {
    depth.masks = slam::InstanceMasks::depth_clusters;
  } else if (is_by_dbscan(cell.masks)) {
    depth.masks = slam::InstanceMasks::dbscan;
  }
  const bool paper = cell.masks == MaskSource::static_paper;
  if (paper) depth.foreground.mode = slam::ForegroundMode::paper;
  if (gives_back(cell.masks)) {
    settings.semantics.static_points.constraint.mode =
        paper ? slam::StaticPointMode::paper : slam::StaticPointMode::adaptive;
  }
  return settings;
}

slam::LoopEvaluation loops_of(const slam::Slam& slam, const slam::Trajectory& truth) {
  std::vector<slam::FramePair> loops, covisible;
  for (const slam::ClosedLoop& loop : slam.loops()) loops.push_back({loop.frame, loop.earlier_frame});
  std::vector<int> keyframes;
  for (const slam::KeyFrame* keyframe : slam.map().keyframes()) {
    keyframes.push_back(keyframe->frame_index);
    for (const slam::Covisible& c : keyframe->covisibles) {
      if (c.keyframe->id < keyframe->id)
        covisible.push_back({keyframe->frame_index, c.keyframe->frame_index});
    }
  }
  return slam::evaluate_loops(truth, loops, keyframes, covisible);
}

// Mean angle between the estimated and the true turn since the first frame, degrees. (An alignment of the
// whole path would leave the rotation about a straight one open.)
double mean_angle(const slam::Trajectory& truth, const slam::Trajectory& estimate) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const slam::SE3 turned = truth.front().T_wc.inverse() * truth[i].T_wc;
    sum += (turned.inverse() * (estimate.front().T_wc.inverse() * estimate[i].T_wc)).angle();
  }
  return sum / static_cast<double>(truth.size()) * 180.0 / M_PI;
}

}  // namespace

MaskSource parse_mask_source(const std::string& name) {
  for (const auto& [known, source] : kSources) {
    if (name == known) return source;
  }
  std::vector<std::string> names;
  for (const auto& [known, source] : kSources) names.emplace_back(known);
  throw UsageError(fmt::format("--masks: expected one of {}, found '{}'", fmt::join(names, ", "), name));
}

std::string name_of(MaskSource source) {
  for (const auto& [known, other] : kSources) {
    if (other == source) return known;
  }
  return {};
}

std::string AblationCell::drive_name() const {
  return fmt::format("{}_{}x{}_{}_seed{}", preset, size.width, size.height, frames, seed);
}

std::string AblationCell::name() const {
  return fmt::format("{}_{}{}_{}{}{}", drive_name(), name_of(masks), weights.empty() ? "" : "-" + weights,
                     filter, all_frames ? "_all" : "", run == 0 ? "" : fmt::format("_run{}", run));
}

bool AblationCell::is_office() const { return slam::synthetic::is_office_preset(preset); }

std::filesystem::path render_drive(const AblationCell& cell, const std::filesystem::path& folder) {
  const std::filesystem::path drive = folder / cell.drive_name();
  if (std::filesystem::exists(drive / kComplete)) return drive;
  if (cell.is_office()) {
    slam::synthetic::OfficeSettings settings = slam::synthetic::office_preset(cell.preset);
    settings.frames = cell.frames;
    settings.seed = static_cast<std::uint32_t>(cell.seed);
    settings.size = cell.size;
    slam::synthetic::OfficeSequence sequence(settings);
    slam::synthetic::write_tum_layout(sequence, drive, /*overwrite=*/true);
    std::ofstream(drive / kComplete) << "\n";
    return drive;
  }
  slam::synthetic::SequenceSettings settings;
  settings.street = slam::synthetic::street_preset(cell.preset);
  settings.frames = cell.frames;
  settings.seed = static_cast<std::uint32_t>(cell.seed);
  settings.colour = true;
  settings.size = cell.size;
  slam::synthetic::StreetSequence sequence(settings);
  slam::synthetic::write_kitti_layout(sequence, drive, /*overwrite=*/true);
  std::ofstream(drive / kComplete) << "\n";
  return drive;
}

nlohmann::json run_cell(const AblationCell& cell, const std::filesystem::path& drive,
                        const std::string& weights) {
  const auto dataset = slam::open_dataset(drive.string(), {});
  const slam::SlamSettings settings = settings_of(cell);
  slam::Segmenter segmenter;
  if (!weights.empty()) {
    segmenter = make_segmenter(load_network(weights, "", slam_network_config()), dataset->camera(),
                               settings.semantics);
  } else if (cell.masks != MaskSource::none && cell.masks != MaskSource::movers) {
    segmenter = make_segmenter(drive / (cell.is_office() ? "instances" : "sequences/00/instances"),
                               dataset->camera(), settings.semantics);
  }
  slam::Slam slam(dataset->camera(), dataset->sensor(), settings, segmenter);
  slam::Recorder record(slam);
  for (slam::Prefetcher frames(*dataset); frames.has_next();) record.add(slam.process(frames.next()));
  record.finish();

  int occluded = 0;
  for (const slam::FrameResult& result : record.results())
    occluded += result.tracking.state == slam::TrackingState::occluded;
  const slam::Trajectory& truth = *dataset->ground_truth();
  slam::EvaluationOptions options;
  options.segment_lengths = {10.0, 20.0, 40.0};
  if (cell.is_office()) options.rpe_frames = std::min(30, cell.frames - 1);  // a second
  const slam::Trajectory estimate = record.trajectory();
  const slam::Evaluation e = slam::evaluate_trajectory(truth, estimate, options);
  const slam::LoopEvaluation loops = loops_of(slam, truth);
  nlohmann::json json = {{"ate_m", e.ape.rmse},
                         {"rpe_m", e.rpe_frames.rmse},
                         {"angle_deg", mean_angle(truth, estimate)},
                         {"loops", loops.loops.size()},
                         {"loop_precision", loops.precision()},
                         {"loop_recall", loops.keyframe_recall()},
                         {"tracked", record.tracked()},
                         {"lost", record.lost() - occluded},
                         {"occluded", occluded},
                         {"keyframes", slam.map().keyframes().size()}};
  const auto add_statistics = [&](const char* name, const slam::ErrorStatistics& errors) {
    json[fmt::format("{}_mean_m", name)] = errors.mean;
    json[fmt::format("{}_median_m", name)] = errors.median;
    json[fmt::format("{}_sd_m", name)] = errors.std;
  };
  add_statistics("ate", e.ape);
  add_statistics("rpe", e.rpe_frames);
  const auto& stages = slam.timer().stages();
  if (const auto frame = stages.find("frame"); frame != stages.end())
    json["median_ms"] = quantile_of(frame->second.values(), 0.5);
  return json;
}

nlohmann::json summarise_cells(const nlohmann::json& cells) {
  std::map<std::string, std::size_t> row_of;
  nlohmann::json rows = nlohmann::json::array();
  std::vector<std::map<std::string, std::vector<double>>> values;
  for (const nlohmann::json& cell : cells) {
    const std::string key =
        fmt::format("{} {} {} {} {}", cell.at("preset").get<std::string>(),
                    cell.at("masks").get<std::string>(), cell.at("weights").get<std::string>(),
                    cell.at("filter").get<std::string>(), cell.value("all_frames", false));
    const auto [at, added] = row_of.emplace(key, rows.size());
    if (added) {
      rows.push_back({{"preset", cell["preset"]},
                      {"masks", cell["masks"]},
                      {"weights", cell["weights"]},
                      {"filter", cell["filter"]},
                      {"office", cell.value("office", false)},
                      {"all_frames", cell.value("all_frames", false)}});
      values.emplace_back();
    }
    for (const auto& [name, value] : cell.items()) {
      if (value.is_number() && name != "seed" && name != "frames" && name != "run")
        values[at->second][name].push_back(value.get<double>());
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [name, list] : values[r]) {
      double mean = 0.0, square = 0.0;
      for (const double v : list) mean += v / static_cast<double>(list.size());
      for (const double v : list) square += (v - mean) * (v - mean) / static_cast<double>(list.size());
      rows[r][name] = {{"mean", mean}, {"std", std::sqrt(square)}};
      rows[r]["seeds"] = list.size();
    }
  }
  return rows;
}

std::string format_table(const nlohmann::json& rows) {
  std::string table =
      "| preset | masks | filter | seeds | ATE m | RPE m | angle deg | loops | precision % | recall % | lost "
      "| occluded | ms a frame |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const nlohmann::json& row : rows) {
    const auto mean = [&](const char* key) {
      return row.contains(key) ? row[key]["mean"].get<double>() : std::nan("");
    };
    const auto spread = [&](const char* key) {
      return row.contains(key) ? row[key]["std"].get<double>() : std::nan("");
    };
    const std::string weights = row["weights"].get<std::string>();
    table += fmt::format(
        "| {} | {}{} | {} | {} | {:.3f} ± {:.3f} | {:.4f} ± {:.4f} | {:.2f} ± {:.2f} | {:.1f} | {:.0f} | "
        "{:.0f} | {:.1f} | {:.1f} | {:.0f} |\n",
        row["preset"].get<std::string>(), row["masks"].get<std::string>(),
        weights.empty() ? "" : " (" + weights + ")", row["filter"].get<std::string>(),
        row["seeds"].get<int>(), mean("ate_m"), spread("ate_m"), mean("rpe_m"), spread("rpe_m"),
        mean("angle_deg"), spread("angle_deg"), mean("loops"), 100.0 * mean("loop_precision"),
        100.0 * mean("loop_recall"), mean("lost"), mean("occluded"), mean("median_ms"));
  }
  return table;
}

std::string format_office_table(const nlohmann::json& rows) {
  std::string table;
  for (const nlohmann::json& row : rows) {
    if (!row["office"].get<bool>()) continue;
    const auto figures = [&](const std::string& name) {
      const auto mean = [&](const std::string& key) { return row[key]["mean"].get<double>(); };
      return fmt::format("{:.4f} ± {:.4f} | {:.4f} | {:.4f} | {:.4f}", mean(name + "_m"),
                         row[name + "_m"]["std"].get<double>(), mean(name + "_mean_m"),
                         mean(name + "_median_m"), mean(name + "_sd_m"));
    };
    const std::string weights = row["weights"].get<std::string>();
    table += fmt::format("| {} | {}{}{} | {} | {} | {} | {:.0f} |\n", row["preset"].get<std::string>(),
                         row["masks"].get<std::string>(), weights.empty() ? "" : " (" + weights + ")",
                         row["all_frames"].get<bool>() ? ", all frames" : "", row["seeds"].get<int>(),
                         figures("ate"), figures("rpe"), row["median_ms"]["mean"].get<double>());
  }
  if (table.empty()) return table;
  return "| preset | masks | runs | ATE rmse | mean | median | SD | RPE rmse | mean | median | SD | ms a "
         "frame |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|\n" +
         table;
}

}  // namespace penumbra::apps
