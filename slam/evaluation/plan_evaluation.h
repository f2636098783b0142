// How good a plan of the floor is, where the truth is known (`penumbra synth` writes one).
//
// The truth is brought to the plan's cells: a cell is blocked in truth where any of its parts is, and free
// where all that is known of it is free. Cells of which the truth knows nothing do not count.
//
//   free_right      share of the plan's free cells that are free in truth
//   free_near       the same, where a cell beside an obstacle counts as right: of those that are blocked in
//                   truth, ones with a free neighbour do no harm to who keeps a cell's distance
//   blocked_right   share of the plan's blocked cells that have a blocked one of the truth within one cell
//   obstacles       share of the truth's blocked cells beside free ones that the plan knows to be free, that
//                   the plan shows blocked within one cell: what a robot could run into
//
// Source of the idea: the measures of maps in Filatov et al., 2D SLAM quality evaluation methods (FRUCT
// 2017).
#pragma once

#include "slam/map/dense/occupancy_grid.h"

namespace penumbra::slam {

struct PlanScore {
  double free_right = 0.0, free_near = 0.0, blocked_right = 0.0, obstacles = 0.0;  // shares; 1 of nothing
  double free_square_metres = 0.0, blocked_square_metres = 0.0;
};

// Both in the frame of the first camera, as plans of runs and of made recordings are.
PlanScore score_plan(const OccupancyGrid& plan, const OccupancyGrid& truth);

}  // namespace penumbra::slam
