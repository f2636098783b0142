#include "slam/pipeline/setting_fields.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr double kMany = 1e6;  // more than any sensible number of things

// Adds fields under a name that grows with the groups they are in.
class FieldList {
 public:
  FieldList(std::string prefix, std::vector<SettingField>& fields)
      : prefix_(std::move(prefix)), fields_(fields) {}

  FieldList group(const char* name) const { return {fmt::format("{}{}.", prefix_, name), fields_}; }
  void flag(const char* name, bool& value) { fields_.push_back({prefix_ + name, "", &value}); }
  template <class Word>
  void word(const char* name, Word& value) {
    fields_.push_back({prefix_ + name, "", &value});
  }
  template <class Number>
  void number(const char* name, Number& value, const char* unit, double least, double most) {
    fields_.push_back({prefix_ + name, unit, &value, least, most});
  }
  void count(const char* name, int& value, const char* unit, double least = 0.0) {
    number(name, value, unit, least, kMany);
  }
  void share(const char* name, double& value) { number(name, value, "share", 0.0, 1.0); }
  void metres(const char* name, double& value) { number(name, value, "metres", 0.0, 1e4); }
  template <class Number>
  void pixels(const char* name, Number& value) {
    number(name, value, "pixels", 0.0, 1e4);
  }

 private:
  std::string prefix_;
  std::vector<SettingField>& fields_;
};

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

void add(FieldList f, TrackerSettings& s) {
  add(f.group("mismatch_filter"), s.mismatch_filter);
  add(f.group("rigid_mover"), s.rigid_mover);
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
  f.count("fewest_covered_points", s.fewest_covered_points, "stereo points");
  FieldList keyframes = f.group("keyframes");
  keyframes.share("least_similarity", s.keyframes.least_similarity);
  keyframes.share("least_close_share", s.keyframes.least_close_share);
  keyframes.count("longest_gap", s.keyframes.longest_gap, "frames", 1.0);
  f.metres("motion_change_metres", s.motion_change_metres);
  f.number("motion_change_radians", s.motion_change_radians, "radians", 0.0, 3.15);
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
  f.share("redundant_share", s.redundant_share);
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
  f.metres("largest_distance", s.largest_distance);
  f.number("largest_turn", s.largest_turn, "radians", 0.0, 3.15);
  f.metres("drift_metres", s.drift_metres);
  f.share("drift_share", s.drift_share);
  f.count("pause", s.pause, "keyframes");
}

void add(FieldList f, InstanceTrackerSettings& s) {
  FieldList view = f.group("view");
  view.pixels("margin", s.view.margin);
  view.pixels("search_radius", s.view.search_radius);
  view.number("max_distance", s.view.max_distance, "bits", 0.0, 256.0);
  view.count("fewest_stereo", s.view.fewest_stereo, "points");
  FieldList motion = f.group("motion");
  motion.pixels("pixel_sigma", s.motion.pixel_sigma);
  motion.pixels("disparity_sigma", s.motion.disparity_sigma);
  motion.metres("camera_sigma", s.motion.camera_sigma);
  motion.number("still_sigma", s.motion.still_sigma, "metres a second", 0.0, 1e3);
  motion.number("moving_sigma", s.motion.moving_sigma, "metres a second", 0.0, 1e3);
  motion.count("fewest_points", s.motion.fewest_points, "points");
  FieldList companions = f.group("companions");
  companions.flag("enabled", s.companions.enabled);
  companions.number("seconds", s.companions.seconds, "seconds", 0.0, 60.0);
  companions.number("longest", s.companions.longest, "seconds", 0.0, 60.0);
  companions.number("least_speed", s.companions.least_speed, "metres a second", 0.0, 1e3);
  companions.count("fewest_features", s.companions.fewest_features, "features");
  companions.share("least_share", s.companions.least_share);
  companions.pixels("search_radius", s.companions.search_radius);
  companions.pixels("search_disparity", s.companions.search_disparity);
  companions.number("max_distance", s.companions.max_distance, "bits", 0.0, 256.0);
  companions.number("margin", s.companions.margin, "bits", 0.0, 256.0);
  f.share("least_score", s.least_score);
  f.flag("check_motion", s.check_motion);
  f.count("history", s.history, "frames", 1.0);
  f.count("frames_back", s.frames_back, "frames");
  f.number("longest_look", s.longest_look, "seconds", 0.0, 60.0);
  f.share("least_overlap", s.least_overlap);
  f.share("least_containment", s.least_containment);
  f.metres("nearest_metres", s.nearest_metres);
  f.count("most_carried", s.most_carried, "frames");
  f.count("most_missed", s.most_missed, "results");
  f.number("standing_log_odds", s.standing_log_odds, "", -100.0, 100.0);
  f.share("large_share", s.large_share);
  f.count("fewest_others", s.fewest_others, "features");
}

void add(FieldList f, DenseSettings& s) {
  f.number("voxel", s.fusion.voxel, "metres", 0.001, 10.0);
  f.number("depth_noise", s.fusion.depth_noise, "sigma / z^2, 1/metres", 1e-6, 1.0);
  f.number("seen_through", s.fusion.seen_through, "views through for each on a voxel", 0.0, 1e4);
  f.count("fewest_views", s.fusion.fewest_views, "views");
  f.number("step", s.step, "pixels", 1.0, 64.0);
  f.metres("farthest", s.farthest);
  f.metres("least_metres", s.least_metres);
  f.number("least_degrees", s.least_degrees, "degrees", 0.0, 360.0);
  f.number("grow", s.grow, "pixels", 0.0, 64.0);
  FieldList plan = f.group("plan");
  plan.number("cell", s.plan.cell, "metres", 0.001, 100.0);
  plan.number("lowest", s.plan.lowest, "metres above the floor", -10.0, 100.0);
  plan.number("highest", s.plan.highest, "metres above the floor", -10.0, 100.0);
  plan.count("fewest_voxels", s.plan.fewest_voxels, "voxels", 1.0);
}

void add(FieldList f, DepthMaskSettings& s) {
  f.word("masks", s.masks);
  FieldList repair = f.group("repair");
  repair.word("mode", s.repair.mode);
  repair.number("grey_difference", s.repair.grey_difference, "grey values", 1.0, 5.0);
  repair.number("nearer_votes", s.repair.nearer_votes, "of a pixel", 0.0, 10.0);
  repair.share("two_surfaces", s.repair.two_surfaces);
  FieldList object = f.group("object");
  object.word("mode", s.object.mode);
  object.number("clusters", s.object.clusters, "clusters", 1.0, 16.0);
  object.share("ring_share", s.object.ring_share);
  object.number("extent_weight", s.object.extent_weight, "", 0.0, 10.0);
  object.number("contour_weight", s.object.contour_weight, "", 0.0, 10.0);
  object.number("past_weight", s.object.past_weight, "", 0.0, 10.0);
  object.number("least_score", s.object.least_score, "", -10.0, 10.0);
  FieldList consistency = f.group("consistency");
  consistency.flag("enabled", s.consistency.enabled);
  consistency.pixels("threshold", s.consistency.threshold);
  consistency.count("fewest_moving", s.consistency.fewest_moving, "points");
  consistency.share("least_share", s.consistency.least_share);
  consistency.count("longest_gap", s.consistency.longest_gap, "frames");
}

}  // namespace

std::vector<SettingField> setting_fields(SlamSettings& s) {
  std::vector<SettingField> fields;
  FieldList all("", fields);
  add(all.group("orb"), s.orb);
  add(all.group("tracker"), s.tracker);
  add(all.group("mapper"), s.mapper);
  add(all.group("place_index"), s.index);
  add(all.group("loops"), s.loops);
  FieldList semantics = all.group("semantics");
  semantics.word("mode", s.semantics.mode);
  semantics.count("interval", s.semantics.interval, "frames", 1.0);
  semantics.number("threads", s.semantics.threads, "threads; 0: all of the others but one", 0.0, 256.0);
  add(semantics.group("instances"), s.semantics.instances);
  add(semantics.group("depth_masks"), s.semantics.depth_masks);
  FieldList full = all.group("full_bundle");
  full.count("robust_iterations", s.full_bundle.robust_iterations, "iterations");
  full.count("iterations", s.full_bundle.iterations, "iterations");
  full.pixels("disparity_offset_sigma", s.full_bundle.disparity_offset_sigma);
  add(all.group("dense"), s.dense);
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
    if (is_number && !(value >= field.least && value <= field.most)) {
      throw InputError(
          fmt::format("{}, {}", place, field.name),
          fmt::format("{:g} to {:g}{}{}", field.least, field.most, *field.unit ? " " : "", field.unit),
          fmt::format("{:g}", value));
    }
  }
}

}  // namespace penumbra::slam
