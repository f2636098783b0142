// Finds a frame's pose without a prediction: by comparing it with the newest keyframes.
//
// For each keyframe: descriptors of its map points against the frame's (slam/features/descriptor_matcher.h),
// P3P in RANSAC, then the pose optimizer. The keyframe with the most inliers wins. About 5 ms a keyframe.
#pragma once

#include <optional>
#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"
#include "slam/tracking/frame.h"

namespace penumbra::slam {

struct Recognition {
  KeyFrame* keyframe = nullptr;  // the one that was recognised
  SE3 T_cw;
  std::vector<MapPoint*> points;  // per feature of the frame: the map point it shows, or nullptr
  int inliers = 0;
};

// Nothing where no keyframe gives `fewest_inliers`. The random draws depend on the frame's index only.
std::optional<Recognition> recognise_frame(const StereoCamera& camera, const Frame& frame, const Map& map,
                                           int newest_keyframes, int fewest_inliers);

}  // namespace penumbra::slam
