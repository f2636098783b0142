// Census transform: a pixel as 24 bits that say which of its neighbours are darker than it.
//
//   bit i = 1  where  I(x + dx_i, y + dy_i) < I(x, y)
//
// (dx, dy) go through the 5 x 5 pixels around it row by row, without the middle, the first one at the highest
// bit; beyond the border the outermost pixel counts. What the bits say does not change with a camera's gain
// and exposure. Cost: 24 comparisons a pixel, of both images 6 % of dense_disparity.h's.
//
// Source: Zabih, Woodfill, Non-parametric local transforms for computing visual correspondence (ECCV 1994).
#pragma once

#include <cstdint>

#include "nn/image/image.h"

namespace penumbra::slam {

using CensusImage = Image<std::uint32_t>;
constexpr int kCensusBits = 24;

// `grey`: one channel, not empty. `out` becomes an image of its size.
void census_transform(const ByteView& grey, CensusImage& out);

}  // namespace penumbra::slam
