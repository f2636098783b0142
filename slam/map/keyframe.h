// A frame that the map remembers: its features, the points they show, and its place in the covisibility
// graph.
#pragma once

#include <memory>
#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/frontend/features/measurement.h"
#include "slam/frontend/features/patch.h"
#include "slam/geometry/se3.h"
#include "slam/map/map_point.h"
#include "slam/map/seen_object.h"

namespace penumbra::slam {

// Edge of the covisibility graph: the other keyframe and how many points both see.
struct Covisible {
  KeyFrame* keyframe = nullptr;
  int shared_points = 0;
};

// Owned and changed by Map and the mapper; everybody else reads.
struct KeyFrame {
  int id = 0;
  int frame_index = 0;     // frame of the sequence
  double timestamp = 0.0;  // seconds
  SE3 T_cw;
  std::shared_ptr<const FrameFeatures> features;  // as they were measured
  // Where its features are, as far as that is known better than measured (feature_view.h); may be null.
  std::shared_ptr<const FeaturePixels> pixels;
  std::vector<char> movable;      // per feature: 1 where it is known to lie on something that moves
  std::vector<MapPoint*> points;  // per feature; nullptr where it shows no point
  // Per feature: 1 where its pixel is that of the point's patch, 0 where only the descriptors are alike.
  std::vector<char> aligned;
  // Of all features; given away once the mapper has handed them to the points.
  std::shared_ptr<const std::vector<Patch>> patches;
  std::vector<Covisible> covisibles;  // most shared points first
  std::vector<SeenObject> objects;    // each once; none where nothing was segmented

  // Keyframes of one sub-map are tied to each other by points. Where the way was lost and nothing was
  // recognised a new sub-map begins, at a guessed pose, until a loop merges it into the older one.
  int submap = 0;

  // An erased keyframe keeps only its place relative to the keyframe that stands in for it.
  bool erased = false;
  KeyFrame* stand_in = nullptr;
  SE3 T_c_stand_in;

  // Its features as they are known by now; not of an erased one.
  FeatureView view() const { return {*features, pixels, movable}; }
};

// What `feature` of a keyframe measures of the point that it shows.
inline PixelMeasurement measurement_of(const KeyFrame& keyframe, int feature,
                                       const std::vector<double>& scales) {
  return measurement_of(keyframe.view(), feature, scales,
                        keyframe.aligned[static_cast<std::size_t>(feature)] != 0);
}

// Pose of a keyframe, erased or not, from its stand-ins' present poses.
inline SE3 current_pose(const KeyFrame& keyframe) {
  SE3 T = keyframe.erased ? keyframe.T_c_stand_in : keyframe.T_cw;
  for (const KeyFrame* k = &keyframe; k->erased;) {
    k = k->stand_in;
    T = T * (k->erased ? k->T_c_stand_in : k->T_cw);
  }
  return T;
}

}  // namespace penumbra::slam
