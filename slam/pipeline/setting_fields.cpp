#include "slam/pipeline/setting_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

#include "nn/base/error.h"
#include "slam/pipeline/field_list.h"

namespace penumbra::slam {

namespace {

void add(FieldList f, OrbSettings& s) {
  f.number("features", s.features, "per image; 0: by its size", 0.0, 20000.0);
  f.number("levels", s.pyramid.levels, "of the pyramid", 1.0, 16.0);
  f.number("scale_factor", s.pyramid.scale_factor, "from level to level", 1.01, 4.0);
  f.number("fast_threshold", s.fast_threshold, "grey values", 1.0, 255.0);
  f.number("lowest_fast_threshold", s.lowest_fast_threshold, "grey values", 1.0, 255.0);
  f.number("cell_size", s.cell_size, "pixels of the level", 8.0, 1e4);
}

void add(FieldList f, MismatchFilterSettings& s) {
  f.word("mode", s.mode);
  f.number("fence", s.fence, "interquartile ranges", 0.0, 100.0);
  f.share("density_share", s.density_share);
}

void add(FieldList f, RigidMoverSettings& s) {
  f.flag("enabled", s.enabled);
  f.count("fewest_points", s.fewest_points, "points");
  f.share("least_share", s.least_share);
  f.metres("least_motion", s.least_motion);
  f.metres("width", s.width);
  f.metres("height", s.height);
  f.metres("length", s.length);
}

void add(FieldList f, ConstellationSettings& s) {
  f.flag("enabled", s.enabled);
  f.count("neighbours", s.neighbours, "keyframes");
  f.metres("tolerance_metres", s.tolerance_metres);
  f.share("tolerance_share", s.tolerance_share);
  f.count("fewest_agreeing", s.fewest_agreeing, "objects");
  f.count("fewest_more_than_rival", s.fewest_more_than_rival, "objects");
  f.metres("least_spread", s.least_spread);
  f.share("most_contradicted", s.most_contradicted);
  f.metres("nearest", s.nearest);
  f.metres("farthest", s.farthest);
  f.pixels("rim", s.rim);
}

void add(FieldList f, PlaceVerifierSettings& s) {
  f.count("fewest_ransac_inliers", s.fewest_ransac_inliers, "points");
  f.count("fewest_inliers", s.fewest_inliers, "points");
  f.share("least_share", s.least_share);
  f.number("fewest_cells", s.fewest_cells, "of 32 cells", 0.0, 32.0);
  f.count("neighbours", s.neighbours, "keyframes");
  add(f.group("constellation"), s.constellation);
  f.count("fewest_supported_inliers", s.fewest_supported_inliers, "points");
  f.share("least_supported_share", s.least_supported_share);
  f.number("fewest_supported_cells", s.fewest_supported_cells, "of 32 cells", 0.0, 32.0);
}

void add(FieldList f, TrackerSettings& s, RigidMoverSettings& rigid_mover) {
  add(f.group("mismatch_filter"), s.mismatch_filter);
  add(f.group("rigid_mover"), rigid_mover);
  f.share("occluded_share", s.occluded_share);
  f.pixels("search_radius", s.search_radius);
  f.pixels("wide_search_radius", s.wide_search_radius);
  f.pixels("map_search_radius", s.map_search_radius);
  f.count("fewest_initial_points", s.fewest_initial_points, "stereo points");
  f.count("fewest_frame_inliers", s.fewest_frame_inliers, "pairs");
  f.share("clear_share", s.clear_share);
  f.count("fewest_map_inliers", s.fewest_map_inliers, "points");
  f.count("fewest_step_inliers", s.fewest_step_inliers, "pairs");
  f.count("fewest_occluded_inliers", s.fewest_occluded_inliers, "points");
  f.metres("largest_surprise", s.largest_surprise);
  f.count("local_keyframes", s.local_keyframes, "keyframes", 1.0);
  FieldList recognition = f.group("recognition");
  recognition.count("last_keyframes", s.recognition.last_keyframes, "keyframes");
  recognition.count("candidates", s.recognition.candidates, "places");
  add(recognition.group("last"), s.recognition.last);
  add(recognition.group("anywhere"), s.recognition.anywhere);
  f.count("lost_before_restart", s.lost_before_restart, "frames", 1.0);
  f.count("occluded_before_restart", s.occluded_before_restart, "frames", 1.0);
  f.count("steps_before_restart", s.steps_before_restart, "frames");
  f.count("fewest_covered_points", s.fewest_covered_points, "stereo points");
  FieldList keyframes = f.group("keyframes");
  keyframes.share("least_similarity", s.keyframes.least_similarity);
  keyframes.by_sensor("least_close_share", s.keyframes.least_close_share, "share; 0: by the sensor", 0.0,
                      1.0);
  keyframes.number("longest_gap_seconds", s.keyframes.longest_gap_seconds, "seconds", 0.0, 1e9);
  f.metres("motion_change_metres", s.motion_change_metres);
  f.number("motion_change_radians", s.motion_change_radians, "radians", 0.0, 3.15);
  FieldList rim = f.group("rim");
  rim.share("least_covered", s.rim.least_covered);
  rim.count("fewest_inliers", s.rim.fewest_inliers, "pairs");
  rim.share("least_agreeing", s.rim.least_agreeing);
  rim.metres("metres", s.rim.metres);
  rim.number("radians", s.rim.radians, "radians", 0.0, 3.15);
  f.share("least_sharpness", s.least_sharpness);
  f.count("longest_sharpness_wait", s.longest_sharpness_wait, "frames");
}

void add(FieldList f, LocalMapperSettings& s) {
  FieldList points = f.group("point_creation");
  points.number("close_baselines", s.point_creation.close_baselines, "baselines", 1.0, 1e4);
  points.count("fewest_stereo_points", s.point_creation.fewest_stereo_points, "points");
  points.count("neighbours", s.point_creation.neighbours, "keyframes");
  points.metres("nearest_depth", s.point_creation.nearest_depth);
  FieldList bundle = f.group("bundle");
  bundle.count("window", s.bundle.window, "keyframes", 1.0);
  bundle.count("border", s.bundle.border, "keyframes");
  bundle.count("robust_iterations", s.bundle.robust_iterations, "iterations");
  bundle.count("iterations", s.bundle.iterations, "iterations");
  f.count("fuse_neighbours", s.fuse_neighbours, "keyframes");
  f.share("least_found_ratio", s.least_found_ratio);
  f.share("redundant_share", s.culling.redundant_share);
}

void add(FieldList f, PlaceIndexSettings& s) {
  f.number("trees", s.trees, "trees", 1.0, 64.0);
  f.count("leaf_size", s.leaf_size, "descriptors", 1.0);
  f.number("max_distance", s.max_distance, "bits", 0.0, 256.0);
  f.number("margin", s.margin, "bits", 0.0, 256.0);
  f.count("fewest_matches", s.fewest_matches, "descriptors");
}

void add(FieldList f, LoopCloserSettings& s) {
  f.flag("enabled", s.enabled);
  f.flag("corrects", s.corrects);
  add(f.group("verifier"), s.verifier);
  FieldList correction = f.group("correction");
  correction.count("strong_edge", s.correction.strong_edge, "points");
  correction.count("neighbours", s.correction.neighbours, "keyframes");
  correction.pixels("fusion_radius", s.correction.fusion_radius);
  FieldList graph = correction.group("pose_graph");
  graph.count("iterations", s.correction.pose_graph.iterations, "iterations");
  graph.number("initial_lambda", s.correction.pose_graph.initial_lambda, "", 0.0, 1e6);
  graph.number("converged", s.correction.pose_graph.converged, "share of the cost", 0.0, 1.0);
  f.count("candidates", s.candidates, "places");
  f.count("age", s.age, "keyframes");
  f.count("fewest_frames_apart", s.fewest_frames_apart, "frames");
  f.count("consistent", s.consistent, "keyframes", 1.0);
  f.count("window", s.window, "keyframes", 1.0);
  f.metres("agree_metres", s.agree_metres);
  f.number("agree_radians", s.agree_radians, "radians", 0.0, 3.15);
  f.number("least_motion_baselines", s.least_motion_baselines, "baselines", 0.0, 1e4);
  f.number("least_turn", s.least_turn, "radians", 0.0, 3.15);
  f.metres("largest_distance", s.largest_distance);
  f.number("largest_turn", s.largest_turn, "radians", 0.0, 3.15);
  f.metres("drift_metres", s.drift_metres);
  f.share("drift_share", s.drift_share);
  f.count("pause", s.pause, "keyframes");
}

void add(FieldList f, DenseSettings& s) {
  f.by_sensor("voxel", s.fusion.voxel, "metres; 0: by the sensor", 0.001, 10.0);
  f.by_sensor("depth_noise", s.fusion.depth_noise, "sigma / z^2, 1/metres; 0: by the sensor", 1e-6, 1.0);
  f.number("seen_through", s.fusion.seen_through, "views through for each on a voxel", 0.0, 1e4);
  f.by_sensor("fewest_views", s.fusion.fewest_views, "views; 0: by the sensor", 1.0, kMany);
  f.number("step", s.step, "pixels", 1.0, 64.0);
  f.by_sensor("farthest", s.fusion.farthest, "metres; 0: by the sensor", 0.001, 1e4);
  f.by_sensor("least_metres", s.least_metres, "metres; 0: by the sensor", 0.001, 1e4);
  f.number("least_degrees", s.least_degrees, "degrees", 0.0, 360.0);
  f.number("grow", s.grow, "pixels", 0.0, 64.0);
  FieldList plan = f.group("plan");
  plan.by_sensor("cell", s.plan.cell, "metres; 0: by the sensor", 0.001, 100.0);
  plan.by_sensor("lowest", s.plan.lowest, "metres above the floor; 0: by the sensor", 0.001, 100.0);
  plan.number("highest", s.plan.highest, "metres above the floor", -10.0, 100.0);
  plan.count("fewest_voxels", s.plan.fewest_voxels, "voxels", 1.0);
  FieldList stereo = f.group("stereo");
  stereo.by_sensor("shrink", s.stereo.shrink, "sides of the pair to those that are matched; 0: by the sensor",
                   1.0, 64.0);
  stereo.number("disparities", s.stereo.disparities, "pixels of the pair", 1.0, 4096.0);
  stereo.number("noise", s.stereo.noise, "sigma, pixels that are matched", 0.001, 100.0);
  stereo.number("slope_penalty", s.stereo.match.penalties.slope, "bits", 0.0, 1000.0);
  stereo.number("edge_penalty", s.stereo.match.penalties.edge, "bits", 0.0, 1000.0);
  stereo.share("unique", s.stereo.match.choice.unique);
  stereo.number("agree", s.stereo.match.choice.agree, "pixels that are matched", 0.0, 100.0);
  stereo.count("smallest_piece", s.stereo.match.smallest_piece, "pixels that are matched");
}

}  // namespace

std::vector<SettingField> setting_fields(SlamSettings& s) {
  std::vector<SettingField> fields;
  FieldList all("", fields);
  add(all.group("orb"), s.orb);
  add(all.group("tracker"), s.tracker, s.semantics.rigid_mover);
  add(all.group("mapper"), s.mapper);
  add(all.group("place_index"), s.index);
  add(all.group("loops"), s.loops);
  add_semantics(all.group("semantics"), s.semantics);
  FieldList full = all.group("full_bundle");
  full.count("robust_iterations", s.full_bundle.robust_iterations, "iterations");
  full.count("iterations", s.full_bundle.iterations, "iterations");
  full.pixels("disparity_offset_sigma", s.full_bundle.disparity_offset_sigma);
  add(all.group("dense"), s.dense);
  all.flag("moves_depth", s.moves_depth);
  all.flag("localise", s.localise);
  all.number("threads", s.threads, "threads", 1.0, 256.0);
  all.flag("deterministic", s.deterministic);
  return fields;
}

void check_settings(const SlamSettings& settings, const std::string& place) {
  SlamSettings copy = settings;  // fields point to what could be written
  for (const SettingField& field : setting_fields(copy)) {
    const double value = std::visit(
        [](const auto* pointer) -> double {
          using Value = std::remove_cvref_t<decltype(*pointer)>;
          if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
            return static_cast<double>(*pointer);
          } else {
            return 0.0;
          }
        },
        field.value);
    const bool is_number = field.most > field.least;
    const bool is_allowed = (value >= field.least && value <= field.most) || (field.or_zero && value == 0.0);
    if (is_number && !is_allowed) {
      throw InputError(
          fmt::format("{}, {}", place, field.name),
          fmt::format("{:g} to {:g}{}{}", field.least, field.most, *field.unit ? " " : "", field.unit),
          fmt::format("{:g}", value));
    }
  }
}

}  // namespace penumbra::slam
