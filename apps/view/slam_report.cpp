#include "apps/view/slam_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <shared_mutex>

#include "apps/common/command_line.h"
#include "apps/common/rounded.h"
#include "apps/view/processor_times.h"
#include "nn/base/quantile.h"
#include "slam/map/point_uncertainty.h"

namespace penumbra::apps {

namespace {

nlohmann::json settings_json(const SlamRun& run, const slam::SlamSettings& s) {
  return {{"features", s.orb.features},
          {"pyramid_levels", s.orb.pyramid.levels},
          {"scale_factor", s.orb.pyramid.scale_factor},
          {"mismatch_filter", slam::name_of(s.tracker.mismatch_filter.mode)},
          {"segmentation", run.segmentation},
          {"moving", s.semantics.instances.check_motion ? "geometry" : "class"},
          {"movers", s.semantics.rigid_mover.enabled},
          {"constellation", s.loops.verifier.constellation.enabled},
          {"self_calibration", s.full_bundle.disparity_offset_sigma > 0.0},
          {"threads", s.threads},
          {"deterministic", s.deterministic},
          {"localise", s.localise},
          {"least_similarity", s.tracker.keyframes.least_similarity},
          {"least_sharpness", s.tracker.least_sharpness},
          {"local_bundle_window", s.mapper.bundle.window}};
}

nlohmann::json ground_truth_json(const slam::Evaluation& e) {
  nlohmann::json json = {{"ape_rmse_m", e.ape.rmse}, {"path_m", e.kitti.path_length}};
  std::vector<double> lengths;
  for (const slam::SegmentDrift& drift : e.kitti.by_length) lengths.push_back(drift.length);
  json["segments_m"] = lengths;
  if (e.kitti.overall.count > 0) {
    json["t_rel_percent"] = e.kitti.overall.translation;
    json["r_rel_deg_per_100m"] = e.kitti.overall.rotation;
  }
  return json;
}

// [R t], row by row.
nlohmann::json rows_json(const slam::SE3& T) {
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 3; ++row)
    rows.push_back({T.rotation(row, 0), T.rotation(row, 1), T.rotation(row, 2), T.translation[row]});
  return rows;
}

const char* name_of(slam::MotionState state) {
  switch (state) {
    case slam::MotionState::fixed:
      return "fixed";
    case slam::MotionState::still:
      return "still";
    case slam::MotionState::moving:
      break;
  }
  return "moving";
}

nlohmann::json instances_json(const slam::Recorder& record) {
  nlohmann::json list = nlohmann::json::array();
  for (const slam::TrackedInstance& instance : record.instances()) {
    list.push_back({{"id", instance.id},
                    {"class", instance.class_name},
                    {"score", to_a_thousandth(instance.score)},
                    {"detections", instance.detections},
                    {"first_frame", instance.first_frame},
                    {"last_frame", instance.last_frame},
                    {"state", name_of(instance.state())},
                    {"moving_probability", to_a_thousandth(instance.moving_probability())},
                    {"speed_mps", to_a_thousandth(instance.velocity.norm())},
                    {"size_m",
                     {to_a_thousandth(instance.size.x()), to_a_thousandth(instance.size.y()),
                      to_a_thousandth(instance.size.z())}},
                    {"visible_share", to_a_thousandth(instance.visible_share)}});
  }
  return list;
}

nlohmann::json loop_closures_json(const std::vector<slam::ClosedLoop>& loops) {
  nlohmann::json json = nlohmann::json::array();
  for (const slam::ClosedLoop& loop : loops) {
    json.push_back({{"frame", loop.frame},
                    {"earlier_frame", loop.earlier_frame},
                    {"points", loop.inliers},
                    {"objects", loop.objects},
                    {"correction_m", to_a_thousandth(loop.correction_metres)},
                    {"merged_submaps", loop.merged_submaps},
                    {"of_loaded_map", loop.of_loaded_map}});
  }
  return json;
}

// [frame, earlier frame, points, objects]
nlohmann::json recognised_json(const std::vector<slam::RecognisedPlace>& places) {
  nlohmann::json json = nlohmann::json::array();
  for (const slam::RecognisedPlace& place : places) {
    if (place.of_loaded_map) continue;
    json.push_back({place.frame, place.earlier_frame, place.inliers, place.objects});
  }
  return json;
}

nlohmann::json submaps_json(const std::vector<slam::SubmapSummary>& submaps) {
  nlohmann::json json = nlohmann::json::array();
  for (const slam::SubmapSummary& submap : submaps) {
    json.push_back({{"submap", submap.submap},
                    {"first_frame", submap.first_frame},
                    {"last_frame", submap.last_frame},
                    {"frames", submap.frames},
                    {"keyframes", submap.keyframes}});
  }
  return json;
}

// What the map holds, read while its worker may go on.
struct MapSummary {
  int points = 0, uncertain_points = 0;
  double disparity_offset = 0.0;  // pixels
  std::size_t keyframes = 0;      // those of a loaded map included
  std::vector<int> keyframe_frames;
  nlohmann::json covisibility = nlohmann::json::array();
};

MapSummary summary_of(const slam::Recorder& record) {
  MapSummary summary;
  const slam::Map& map = record.slam().map();
  const std::shared_lock lock(map.mutex());
  for (const auto& point : map.points()) {
    if (point->erased) continue;
    ++summary.points;
    summary.uncertain_points += slam::is_mostly_uncertain(*point, map.camera(), map.scales());
  }
  summary.disparity_offset = map.camera().disparity_offset;
  summary.keyframes = map.keyframes().size();
  for (const slam::KeyFrame* keyframe : map.keyframes()) {
    if (!record.slam().is_loaded(*keyframe)) summary.keyframe_frames.push_back(keyframe->frame_index);
    for (const slam::Covisible& c : keyframe->covisibles) {
      if (c.keyframe->id >= keyframe->id || record.slam().is_loaded(*c.keyframe)) continue;
      summary.covisibility.push_back({keyframe->frame_index, c.keyframe->frame_index, c.shared_points});
    }
  }
  return summary;
}

// Along the frames that were located one after the other.
struct Way {
  double metres = 0.0, seconds = 0.0;
};
Way way_of(const slam::Recorder& record) {
  Way way;
  std::optional<slam::TimedPose> before;  // the last frame, where it was located
  const slam::KeptFrames::Poses poses = record.kept().poses();
  for (const slam::KeptFrame& frame : record.frames()) {
    if (!frame.is_located()) {
      before.reset();
      continue;
    }
    const slam::TimedPose here{frame.timestamp, poses.of(frame)};
    if (before && !frame.starts_submap) {
      way.metres += (here.T_wc.translation - before->T_wc.translation).norm();
      way.seconds += here.timestamp - before->timestamp;
    }
    before = here;
  }
  return way;
}

}  // namespace

nlohmann::json revisits_json(const std::vector<slam::ClosedLoop>& loops,
                             const slam::LoopCloserSettings& settings) {
  nlohmann::json json = nlohmann::json::array();
  for (const slam::ClosedLoop& loop : loops) {
    // A piece that was merged soon after the way was lost is no loop.
    const bool is_revisit = loop.frame - loop.earlier_frame >= settings.fewest_frames_apart;
    if (is_revisit && !loop.of_loaded_map) json.push_back({loop.frame, loop.earlier_frame});
  }
  return json;
}

nlohmann::json dense_report(const slam::DenseMap& map, const slam::DenseSettings& settings) {
  nlohmann::json json;
  json["voxels"] = map.voxels.voxels().size();
  json["voxel_m"] = settings.fusion.voxel;
  json["classes"] = map.classes;
  json["views"] = map.views;
  json["megabytes"] = to_a_thousandth(1e-6 * static_cast<double>(map.bytes));
  json["floor"] = map.floor.has_value();
  json["depth_to_m"] = to_a_thousandth(settings.fusion.farthest);
  json["cell_m"] = settings.plan.cell;
  if (map.floor) json["floor_from_m"] = to_a_thousandth(map.floor_from);
  if (map.plan) {
    using Grid = slam::OccupancyGrid;
    json["plan_cells"] = {{"free", map.plan->count(Grid::kFree)},
                          {"blocked", map.plan->count(Grid::kBlocked)},
                          {"unknown", map.plan->count(Grid::kUnknown)}};
    json["plan_from_map"] = rows_json(map.plan->T_plan_world);
  }
  return json;
}

std::string plan_doubt(const slam::DenseMap& map, const slam::DenseSettings& settings, slam::Sensor sensor) {
  constexpr double kStrip = 1.5;  // of where the floor begins
  const double reach = settings.fusion.farthest, cell = settings.plan.cell;
  std::string figures = fmt::format("depth counts as far as {:.3g} m", reach);
  std::string help = "dense.farthest in a file of --settings lets it count farther";
  if (sensor == slam::Sensor::stereo) {
    figures += fmt::format(" with cells of {:g} m", cell);
    // What a cell twice as large would give.
    help = fmt::format("a larger --grid-resolution lets it count farther, as {:g} about {:.3g} m", 2.0 * cell,
                       std::sqrt(2.0) * reach);
  }
  if (!map.plan)
    return fmt::format("no floor was found in the dense map, and there is no plan of it; {}; {}", figures,
                       help);
  if (map.floor_from > 0.0 && reach < kStrip * map.floor_from)
    return fmt::format("the floor comes into the images {:.3g} m ahead, and {}: the plan is of a strip; {}",
                       map.floor_from, figures, help);
  return {};
}

nlohmann::json slam_report(const SlamRun& run, const slam::Recorder& record) {
  std::int64_t filter_kept = 0, filter_removed = 0, movable_features = 0;
  slam::StaticPointCount points;
  std::vector<int> lost_frames, occluded_frames;
  for (const slam::KeptFrame& frame : record.frames()) {
    filter_kept += frame.filter_kept;
    filter_removed += frame.filter_removed;
    movable_features += frame.movable_features;
    points.left_out += frame.static_points.left_out;
    points.compared += frame.static_points.compared;
    points.given_back += frame.static_points.given_back;
    if (!frame.is_located()) lost_frames.push_back(frame.index);
    if (frame.state == slam::TrackingState::occluded) occluded_frames.push_back(frame.index);
  }
  const MapSummary map = summary_of(record);
  const Way way = way_of(record);

  nlohmann::json json;
  json["dataset"] = run.dataset;
  json["command"] = command_line();
  json["version"] = kVersion;
  if (!run.finished) json["unfinished"] = true;
  if (!run.error.empty()) json["error"] = run.error;
  json["warnings"] = run.warnings;
  if (run.body)
    json["body"] = {{"frame", run.body->frame}, {"body_from_camera", rows_json(run.body->T_frame_camera)}};
  if (!run.stream.is_null()) json["stream"] = run.stream;
  if (!run.why_lost.empty()) json["why_lost"] = run.why_lost;
  json["settings"] = settings_json(run, record.slam().settings());
  json["frames"] = record.frames().size();
  json["tracked"] = record.tracked();
  json["lost"] = record.lost();
  json["lost_frames"] = lost_frames;
  json["unreadable_frames"] = run.unreadable_frames;
  json["path_m"] = to_a_thousandth(way.metres);
  json["mean_speed_mps"] = to_a_thousandth(way.seconds > 0.0 ? way.metres / way.seconds : 0.0);
  json["median_depth_m"] = to_a_thousandth(run.median_depth);
  json["keyframes"] = map.keyframe_frames.size();
  json["loaded_keyframes"] = map.keyframes - map.keyframe_frames.size();
  json["map_points"] = map.points;
  json["uncertain_points"] = map.uncertain_points;
  json["disparity_offset_px"] = to_a_thousandth(map.disparity_offset);
  json["movable_features"] = movable_features;
  if (points.left_out > 0) {
    json["static_points"] = {
        {"left_out", points.left_out}, {"compared", points.compared}, {"given_back", points.given_back}};
  }
  json["occluded_frames"] = occluded_frames;
  json["instances"] = instances_json(record);
  if (const std::vector<double>& delays = record.mask_delays().values(); !delays.empty()) {
    json["masks_late_s"] = {{"median", to_a_thousandth(quantile_of(delays, 0.5))},
                            {"most", to_a_thousandth(quantile_of(delays, 1.0))}};
  }
  if (run.peak_arena_bytes > 0) json["peak_arena_bytes"] = run.peak_arena_bytes;
  const double frames = static_cast<double>(std::max<std::size_t>(record.frames().size(), 1));
  json["cpu_ms_per_frame"] = to_a_thousandth(1000.0 * run.cpu_seconds / frames);
  StageTimer tracking = run.dense_times;
  tracking.merge(record.slam().timer());
  StageTimer times = run.input_times;
  times.merge(tracking);
  json["processor_ms"] = processor_report(times.processor(), run.cpu_seconds, record.frames().size());
  json["peak_rss_mb"] = to_a_thousandth(run.peak_rss_mb);
  for (const auto& [stage, spent] : tracking.stages()) {
    const double median = to_a_thousandth(quantile_of(spent.values(), 0.5));
    if (stage == "frame") {
      json["median_ms"] = median;
      json["p95_ms"] = to_a_thousandth(quantile_of(spent.values(), 0.95));
    } else {
      json["stages"][stage] = median;
    }
  }
  json["mismatch_filter"] = {{"kept", filter_kept}, {"removed", filter_removed}};
  if (!run.dense.is_null()) json["dense"] = run.dense;
  if (run.evaluation) json["ground_truth"] = ground_truth_json(*run.evaluation);
  const std::vector<slam::ClosedLoop> loops = record.slam().loops();
  json["loops"] = revisits_json(loops, record.slam().settings().loops);
  json["loop_closures"] = loop_closures_json(loops);
  json["recognised_places"] = recognised_json(record.slam().recognised_places());
  json["submaps"] = submaps_json(record.submaps());
  json["keyframe_frames"] = map.keyframe_frames;
  json["covisibility"] = map.covisibility;
  return json;
}

std::string to_text(const nlohmann::json& report) {
  std::string text;
  for (const auto& [key, value] : report.items()) {
    std::string entry =
        value.dump(value.is_object() ? 2 : -1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = entry.find('\n'); at != std::string::npos; at = entry.find('\n', at + 1)) {
      entry.insert(at + 1, "  ");
    }
    text += fmt::format("{}  \"{}\": {}", text.empty() ? "{\n" : ",\n", key, entry);
  }
  return text + "\n}\n";
}

}  // namespace penumbra::apps
