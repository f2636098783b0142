// New map points for a keyframe: from its own stereo depth, and by triangulation with its neighbours.
#pragma once

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"

namespace penumbra::slam {

struct PointCreationSettings {
  double close_baselines = 40.0;   // stereo depth is trusted up to this many baselines (KITTI: 21 m) ...
  int fewest_stereo_points = 100;  // ... and farther where a keyframe would have fewer points than this
  int neighbours = 4;              // keyframes that are searched for pairs to triangulate
  double nearest_depth = 2.0;      // metres: where the search along an epipolar line starts
};

// Depth up to which stereo alone makes a point.
inline double close_depth(const StereoCamera& camera, const PointCreationSettings& settings) {
  return settings.close_baselines * camera.baseline;
}

// Points for features with stereo depth that show none yet, nearest first. Returns how many.
int create_stereo_points(KeyFrame* keyframe, Map& map, const PointCreationSettings& settings);

// Points for features that show none yet, here and in a covisible keyframe: the pair must be each other's
// likeness (Hamming <= 50, ratio 0.8), lie on its epipolar line, have parallax, and reproject within the
// chi-square gates. Returns how many.
int triangulate_with_neighbours(KeyFrame* keyframe, Map& map, const PointCreationSettings& settings);

}  // namespace penumbra::slam
