// Settings of the dense map (dense_mapper.h).
//
// Where a number is 0 it follows from the sensor (with_derived). Of an RGB-D camera it is what suits a room,
// the defaults of FusionSettings and OccupancySettings, and 0.05 m as least_metres; of a stereo camera it
// follows from the plan's cell and from how deep the pair sees:
//
//   shrink        so many that about 29,000 pixels are matched, and at most 4: of small pairs no pixel is to
//                 be wasted, of large ones time. 1240 x 376: 4, 620 x 188: 2
//   depth_noise   stereo.noise stereo.shrink / (fx b): sigma(z) = depth_noise z^2
//   cell          sigma(24 b) / 2, as 1, 2 or 5 times a power of ten: KITTI's camera 0.2 m, EuRoC's 0.05 m.
//                 Depth then counts as far as about 24 baselines, from where a car sees the road before it
//   voxel         cell / 2
//   farthest      where sigma(z) is two cells
//   fewest_views  2
//   least_metres  a cell
//   lowest        1.5 cells, and at least 0.1 m: what is lower is floor, as far as the noise lets one tell
#pragma once

#include "slam/frontend/disparity/dense_disparity.h"
#include "slam/geometry/sensor.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/map/dense/fusion.h"
#include "slam/map/dense/occupancy_grid.h"

namespace penumbra::slam {

// How depth is found in pairs of images.
struct StereoDepthSettings {
  int shrink = 4;                // sides of the images that are matched, to those of the pair
  int disparities = 128;         // pixels of the pair: what is nearer is not seen
  double noise = 0.25;           // standard deviation of a disparity, pixels of the images that are matched
  DisparitySettings match = {};  // its `disparities` follow from those here
};

struct DenseSettings {
  FusionSettings fusion{.voxel = 0.0, .depth_noise = 0.0, .farthest = 0.0, .fewest_views = 0};
  OccupancySettings plan{.cell = 0.0, .lowest = 0.0};
  StereoDepthSettings stereo{.shrink = 0};
  int step = 2;                // of RGB-D: pixels between those that are taken
  double least_metres = 0.0;   // a view nearer than this to the last one ...
  double least_degrees = 3.0;  // ... and turned less than this is left out
  int grow = 6;                // pixels around a mask of what moves that are left out with it
};

DenseSettings with_derived(DenseSettings settings, Sensor sensor, const StereoCamera& camera);

}  // namespace penumbra::slam
