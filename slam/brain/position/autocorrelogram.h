// How a rate map agrees with itself moved by (dx, dy) bins: the spatial autocorrelogram, in which a grid
// cell's lattice shows whatever its phase.
//
//   r(dx, dy) = (n S_ab - S_a S_b) / sqrt((n S_aa - S_a^2) (n S_bb - S_b^2))
//
// a is the rate in a bin, b that of the bin at (dx, dy) from it, both known; n such pairs. 0 where n <= 30
// or where nothing changes.
//
// Cost: 3 ms for 40 x 40 bins.
// Source: Sargolini et al., Conjunctive representation of position, direction, and velocity in entorhinal
// cortex (2006), equation 1 of the supplement.
#pragma once

#include <vector>

#include "slam/brain/position/rate_map.h"

namespace penumbra::slam::brain {

struct Autocorrelogram {
  int radius = 0;             // lags -radius..radius in both directions, bins
  std::vector<float> values;  // (2 radius + 1)^2, row after row, dy = -radius first

  float at(int dx, int dy) const {
    return values[static_cast<std::size_t>((dy + radius) * (2 * radius + 1) + dx + radius)];
  }
};

// To radius size - 7: beyond, too few bins overlap.
Autocorrelogram autocorrelogram(const RateMap& map);

}  // namespace penumbra::slam::brain
