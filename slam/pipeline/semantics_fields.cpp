#include "slam/pipeline/field_list.h"

namespace penumbra::slam {

namespace {

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
  f.share("known_score_share", s.known_score_share);
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

void add(FieldList f, DepthMaskSettings& s) {
  f.word("masks", s.masks);
  FieldList repair = f.group("repair");
  repair.word("mode", s.repair.mode);
  repair.number("grey_difference", s.repair.grey_difference, "grey values", 1.0, 5.0);
  repair.number("nearer_votes", s.repair.nearer_votes, "of a pixel", 0.0, 10.0);
  repair.share("two_surfaces", s.repair.two_surfaces);
  repair.number("farthest", s.repair.farthest, "pixels", 1.0, 10000.0);
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
  FieldList foreground = f.group("foreground");
  foreground.word("mode", s.foreground.mode);
  foreground.number("eps", s.foreground.eps, "of the depth", 0.0, 1.0);
  foreground.share("ring_share", s.foreground.ring_share);
  foreground.count("fewest", s.foreground.fewest, "features", 2.0);
}

void add(FieldList f, StaticPointSettings& s) {
  f.word("mode", s.constraint.mode);
  f.pixels("line_pixels", s.constraint.line_pixels);
  f.pixels("shift_pixels", s.constraint.shift_pixels);
  f.metres("depth_metres", s.constraint.depth_metres);
  f.number("score", s.constraint.score, "pixels and metres", 0.0, 1e4);
  f.number("pixel_sigma", s.constraint.pixel_sigma, "pixels", 1e-3, 1e4);
  f.number("disparity_sigma", s.constraint.disparity_sigma, "pixels", 1e-3, 1e4);
  f.metres("pose_sigma", s.constraint.pose_sigma);
  f.number("least_age", s.least_age, "seconds", 0.0, 60.0);
  f.number("longest_age", s.longest_age, "seconds", 0.0, 60.0);
  f.metres("reach", s.reach);
  f.count("fewest_others", s.fewest_others, "features");
  f.pixels("search_radius", s.search_radius);
  f.pixels("neighbourhood", s.neighbourhood);
  f.share("like_depth", s.like_depth);
  f.count("fewest_neighbours", s.fewest_neighbours, "features", 1.0);
  f.share("agreeing_share", s.agreeing_share);
  f.share("agreeing_share_unmatched", s.agreeing_share_unmatched);
}

}  // namespace

void add_semantics(FieldList f, SemanticsSettings& s) {
  f.word("mode", s.mode);
  f.count("interval", s.interval, "frames", 1.0);
  f.number("longest_gap_seconds", s.longest_gap_seconds, "seconds", 0.0, 1e9);
  f.flag("keeps_pace", s.keeps_pace);
  f.number("threads", s.threads, "threads; 0: all of the others but one", 0.0, 256.0);
  add(f.group("instances"), s.instances);
  add(f.group("static_points"), s.static_points);
  add(f.group("depth_masks"), s.depth_masks);
}

}  // namespace penumbra::slam
