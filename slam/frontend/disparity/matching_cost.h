// How unlike a pixel of the left image and one of the right are, for each disparity.
//
//   C(x, y, d) = number of bits in which the census of left (x, y) and of right (x - d, y) differ
//
// 0 to 24; all 24 where x - d is left of the right image. Cost: 15 operations a pixel and disparity, which
// the compiler does on vectors along d: 13 % of dense_disparity.h's.
#pragma once

#include <cstdint>

#include "slam/frontend/disparity/census.h"
#include "slam/frontend/disparity/disparity_volume.h"

namespace penumbra::slam {

// Both of one size; `disparities`: 0 to disparities - 1 are compared.
void matching_cost(const CensusImage& left, const CensusImage& right, int disparities,
                   DisparityVolume<std::uint8_t>& cost);

}  // namespace penumbra::slam
