// A plan of the floor for robots: which cells are free, which are blocked, seen from above.
//
//   blocked   something stands in the cell between `lowest` and `highest` above the floor
//   free      the floor was seen there, within `lowest` / 2, and nothing blocks it; also a cell of which 5 of
//             8 neighbours are free
//   unknown   all else
//
// Frame of the plan: x to where the first camera looked, y to its left, z up, the origin on the floor below
// it. Files as ROS' map_server and nav2_map_server read them: NAME.pgm (254 free, 0 blocked, 205 unknown; the
// first row has the largest y) and NAME.yaml beside it.
#pragma once

#include <filesystem>

#include "nn/image/image.h"
#include "slam/map/dense/floor_plane.h"
#include "slam/map/dense/voxel_grid.h"

namespace penumbra::slam {

struct OccupancySettings {
  double cell = 0.05;                  // metres
  double lowest = 0.1, highest = 1.8;  // metres above the floor: what blocks a robot
  int fewest_voxels = 3;               // that block a cell
};

struct OccupancyGrid {
  static constexpr std::uint8_t kFree = 254, kBlocked = 0, kUnknown = 205;

  double cell = 0.05;                                // metres
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // of the lower left corner, metres
  SE3 T_plan_world;
  ByteImage cells;  // the first row has the largest y

  int count(std::uint8_t kind) const;
};

// `first_camera`: T_wc. An empty grid of voxels gives one unknown cell.
OccupancyGrid occupancy_of(const VoxelGrid& voxels, const FloorPlane& floor, const SE3& first_camera,
                           const OccupancySettings& settings);

// The plan's frame above a floor, for who draws one by himself. T_plan_world; where the camera looks straight
// down, x is where its top points.
SE3 plan_from_world(const FloorPlane& floor, const SE3& first_camera);

// Writes `path` with the endings .pgm and .yaml. Throws Error where that fails.
void write_occupancy(const std::filesystem::path& path, const OccupancyGrid& grid);

// Reads a map_server's YAML file (plan_file.h) and its image: of Penumbra, nav2_map_saver, or drawn by hand;
// T_plan_world stays the identity. Throws InputError as read_plan_file() and nn::read_image() do.
OccupancyGrid read_occupancy(const std::filesystem::path& yaml);

}  // namespace penumbra::slam
