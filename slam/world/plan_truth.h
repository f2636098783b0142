// Where a robot could drive in a world: the truth that plans of the floor are compared with
// (slam/map/dense/occupancy_grid.h).
//
//   blocked   a body of something that does not move cuts one of nine upright lines through the cell between
//             `lowest` and `highest`; outside of a room, too
//   free      all else of the ground within `around` metres of the camera's path
//   unknown   what is farther, and where nothing but leaves cuts them
//
// The plan's frame is that of plans of runs: x to where the first camera looked. Cost: a microsecond a
// cell that a thing's box covers, nine where it is free.
#pragma once

#include "slam/map/dense/occupancy_grid.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

// `poses`: T_wc, at least one.
OccupancyGrid true_plan(const World& world, const Trajectory& poses, const OccupancySettings& settings,
                        double around);
// As sequences are written with it: cells of 0.1 m in a street and 0.05 m in a room, 30 m and 5 m around.
OccupancyGrid true_plan(const World& world, const Trajectory& poses);

}  // namespace penumbra::slam::synthetic
