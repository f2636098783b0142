// One stereo frame: what was measured in it, and, once it was located, where it is and what it shows.
#pragma once

#include <memory>
#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/frontend/features/image_pyramid.h"
#include "slam/frontend/features/patch.h"
#include "slam/geometry/se3.h"
#include "slam/map/keyframe.h"

namespace penumbra::slam {

// A point that a frame shows and that is in no map yet: the frame before has measured it.
struct LoosePoint {
  int feature = 0;                                     // of the frame
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world
  const Patch* patch = nullptr;                        // of the frame before
  double patch_depth = 0.0;                            // metres
};

struct Frame {
  // What is known before it is located.
  int index = 0;                                  // in the sequence
  double timestamp = 0.0;                         // seconds
  std::shared_ptr<const FrameFeatures> features;  // as they were measured
  const ImagePyramid* pyramid = nullptr;          // of the left image; only while the frame is tracked
  const Features* right = nullptr;                // of the right image, likewise; null: there are none
  std::vector<char> movable;        // per feature: 1 on what moves; locating it may find more of them
  double covered_share = 0.0;       // of the image, by what is known to move
  std::vector<SeenObject> objects;  // that it is known to show

  // What the tracker adds.
  SE3 T_cw;
  std::vector<MapPoint*> points;  // per feature: the map point it shows, or nullptr
  std::vector<char> aligned;      // per feature: 1 where the point's patch was found at its pixel
  std::shared_ptr<const FeaturePixels> pixels;        // where its features are; null where it is lost
  std::shared_ptr<const std::vector<Patch>> patches;  // per feature

  // Where it is relative to a keyframe: keyframes move when the map is adjusted, and the frame moves along.
  const KeyFrame* reference = nullptr;
  SE3 T_c_reference;

  // Its features as they are known by now.
  FeatureView view() const { return {*features, pixels, movable}; }
};

}  // namespace penumbra::slam
