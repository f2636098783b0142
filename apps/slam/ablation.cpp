#include "apps/slam/ablation.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "apps/network/load_network.h"
#include "apps/slam/point_truth.h"
#include "apps/slam/segmenter.h"
#include "apps/view/frame_picture.h"
#include "nn/base/error.h"
#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "slam/evaluation/alignment.h"
#include "slam/evaluation/ape.h"
#include "slam/evaluation/evaluation.h"
#include "slam/evaluation/loop_evaluation.h"
#include "slam/evaluation/trajectory_plot.h"
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
  settings.semantics.rigid_mover.enabled = settings.semantics.instances.companions.enabled =
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
  depth.foreground.mode = paper ? slam::ForegroundMode::paper : slam::ForegroundMode::adaptive;
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
    settings.flow = true;  // the truth about points
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
                        const std::string& weights, const std::filesystem::path& pictures) {
  const auto dataset = slam::open_dataset(drive.string(), {});
  slam::SlamSettings settings = settings_of(cell);
  slam::Segmenter segmenter;
  if (!weights.empty()) {
    const LoadedNetwork loaded = load_network(weights, "", slam_network_config());
    settings.semantics.instances.least_score = least_score_of(loaded);
    segmenter = make_segmenter(loaded, dataset->camera(), settings.semantics);
  } else if (cell.masks != MaskSource::none && cell.masks != MaskSource::movers) {
    segmenter = make_segmenter(drive / (cell.is_office() ? "instances" : "sequences/00/instances"),
                               dataset->camera(), settings.semantics);
  }
  slam::Slam slam(dataset->camera(), dataset->sensor(), settings, segmenter);
  slam::Recorder record(slam);
  const std::optional<PointTruth> points =
      cell.is_office() ? PointTruth::open(drive, dataset->camera(), *dataset->ground_truth()) : std::nullopt;
  JudgedPoints judged;
  int most_movable = -1;
  for (slam::Prefetcher frames(*dataset); frames.has_next();) {
    const slam::StereoImages images = frames.next();
    slam.keep_pace(images.timestamp);
    const slam::FrameResult& result = record.add(slam.process(images));
    if (points) points->judge(images.index, slam.newest_view(), judged);
    // Before there was no earlier view to give anything back by.
    const bool is_late = images.index >= cell.frames / 2;
    if (!cell.is_office() || !is_late || result.movable_features <= most_movable) continue;
    most_movable = result.movable_features;
    nn::write_image(pictures / (cell.name() + ".png"), draw_frame(images.left, slam.newest_view()));
  }
  record.finish();

  int occluded = 0;
  for (const slam::KeptFrame& frame : record.frames())
    occluded += frame.state == slam::TrackingState::occluded;
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
  const auto add_stage = [&](const char* key, const char* stage) {
    if (const auto at = stages.find(stage); at != stages.end())
      json[key] = quantile_of(at->second.values(), 0.5);
  };
  add_stage("median_ms", "frame");
  add_stage("static_points_ms", "static_points");
  if (points) {
    json["moving_recall"] = judged.moving_recall();
    json["standing_kept"] = judged.standing_share();
  }
  if (cell.is_office()) {
    slam::TrajectoryPlotOptions plot;
    plot.title = cell.name();
    plot.plane = slam::PlotPlane::xz;
    slam::write_plot(pictures / (cell.name() + ".svg"),
                     slam::draw_trajectories(e.aligned_estimate, truth, plot));
  }
  return json;
}

}  // namespace penumbra::apps
