// Trains the grid cells of one module and measures what they have become: gridness of the frozen and of the
// live maps (rate_map.h; live ones of the second half of the walk), and how many cells are alike.
//
// Cost: the training and 8 ms a cell.
#pragma once

#include <vector>

#include "slam/brain/position/grid_training.h"
#include "slam/brain/position/gridness.h"
#include "slam/brain/position/rate_map.h"

namespace penumbra::slam::brain {

struct GridMeasurement {
  std::vector<RateMap> frozen, live;                   // a map a cell
  std::vector<double> frozen_gridness, live_gridness;  // on the fixed ring
  std::vector<double> frozen_best, live_best;          // on the best ring
  double alike_weights = 0.0;  // share of the pairs of cells with |cos| of their weights above 0.95
  double alike_maps = 0.0;     // share of the pairs whose frozen maps correlate by more than 0.8
  bool finite = true;          // else nothing above is set
};

GridMeasurement measure_grid_cells(const GridTrainingSettings& settings, bool untrained = false);

}  // namespace penumbra::slam::brain
