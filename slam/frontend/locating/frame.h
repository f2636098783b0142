// One stereo frame on its way through the tracker.
#pragma once

#include <memory>
#include <vector>

#include "slam/frontend/features/frame_features.h"
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
  int index = 0;                            // in the sequence
  double timestamp = 0.0;                   // seconds
  std::shared_ptr<FrameFeatures> features;  // the tracker sharpens their positions, then nobody does
  const ImagePyramid* pyramid = nullptr;    // of the left image; only while the frame is tracked
  std::shared_ptr<const std::vector<Patch>> patches;  // per feature; given by the tracker
  double covered_share = 0.0;                         // of the image, by what is known to move
  std::vector<SeenObject> objects;                    // that it is known to show
  SE3 T_cw;
  std::vector<MapPoint*> points;  // per feature: the map point it shows, or nullptr
  std::vector<char> aligned;      // per feature: 1 where the point's patch was found at its pixel

  // Where it is relative to a keyframe: keyframes move when the map is adjusted, and the frame moves along.
  const KeyFrame* reference = nullptr;
  SE3 T_c_reference;
};

}  // namespace penumbra::slam
