// One answer to the question where a frame was taken, and all that goes with it.
//
// Each way to locate a frame (by_motion.h, by_descriptors.h, by_turning.h, by_place.h) fills a hypothesis
// from what is known, which it leaves as it is. The tracker compares hypotheses and takes one; what the
// others have found is gone with them.
#pragma once

#include <optional>
#include <vector>

#include "slam/dynamics/instance.h"
#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/locating/frame.h"

namespace penumbra::slam {

// What comparing a frame with the last one showed.
struct PairsReport {
  int frame_matches = 0;          // pairs
  MismatchFilterReport filter;    // what the mismatch filter did with them
  int frame_inliers = 0;          // pairs that agree with the pose
  std::optional<Instance> mover;  // a large thing that moves, found by geometry alone
};

struct Hypothesis {
  bool success = false;  // enough agrees with the pose; else nothing below but `report` means anything
  SE3 T_cw;
  // Entry i of each belongs to feature i of the frame.
  std::vector<MapPoint*> points;  // the map point that it shows, or nullptr
  FeaturePixels pixels;           // where it is: measured, or moved to where its point's patch was found
  std::vector<char> aligned;      // 1 where the patch was found: then the pixel weighs more (measurement.h)
  std::vector<char> movable;      // 1 where it is taken to lie on something that moves

  std::vector<LoosePoint> loose;      // points that it shows and that are in no map
  std::vector<MapPoint*> looked_for;  // map points that it should show
  KeyFrame* reference = nullptr;      // the keyframe with which it shares the most points
  PairsReport report;                 // how it compares with the last frame
  int inliers = 0;       // what agrees with the pose: map points, or off the map pairs with the last frame
  bool off_map = false;  // found by the last frame alone: the map does not reach here yet
  Matrix6d information = Matrix6d::Zero();  // of the pose, by the map (PoseEstimate); 0 off the map

  // Pairs with the last frame that agree with the pose.
  int pairs() const { return report.frame_inliers; }
  FeatureView view(const Frame& frame) const { return {*frame.features, pixels, movable}; }

  // As the frame was measured, nothing found yet. The memory of the last one is reused.
  void begin(const Frame& frame, KeyFrame* old_reference);
};

}  // namespace penumbra::slam
