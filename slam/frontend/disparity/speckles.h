// Removes small pieces of a disparity image: pixels that hang together, each within `step` of its neighbour,
// and are fewer than `fewest`. Wrong matches come in such pieces. Neighbours are above, below and beside.
// Cost: 4 % of dense_disparity.h's.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/image/image.h"

namespace penumbra::slam {

class SpeckleFilter {
 public:
  // Pixels of 0 have no disparity, and become so.
  void apply(FloatImage& disparity, float step, int fewest);

 private:
  std::vector<std::uint8_t> seen_;
  std::vector<std::int32_t> piece_;  // its pixels, those at the end to be looked at
};

}  // namespace penumbra::slam
