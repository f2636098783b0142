// Settings of the dense map (dense_mapper.h).
#pragma once

#include "slam/map/dense/fusion.h"
#include "slam/map/dense/occupancy_grid.h"

namespace penumbra::slam {

struct DenseSettings {
  FusionSettings fusion;
  OccupancySettings plan;
  int step = 2;                // pixels between those that are taken
  double least_metres = 0.05;  // a view nearer than this to the last one ...
  double least_degrees = 3.0;  // ... and turned less than this is left out
  int grow = 6;                // pixels around a mask of what moves that are left out with it
};

}  // namespace penumbra::slam
