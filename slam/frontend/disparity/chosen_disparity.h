// The disparity of each left pixel, from the costs of all that it may have.
//
//   d(x, y) = argmin_d S(x, y, d), the smallest of equal ones, and a fraction from the costs beside it:
//             d + (S(d-1) - S(d+1)) / (2 max(S(d-1) - S(d), S(d+1) - S(d)))
//
// (two lines of opposite slopes through the three costs, which fits sums of absolute differences better than
// a parabola does). None where
//
//   - another disparity, not next to it, costs less than (1 + `unique`) times as much,
//   - the right pixel that it leads to has another one: argmin_d S(x + d, y, d) differs by more than `agree`,
//   - d is 0 or the largest: there is no cost beyond it, and the true one may lie there.
//
// Cost: 14 % of dense_disparity.h's.
//
// Source: Hirschmueller 2008, section II-C; Haller, Nedevschi, Design of interpolation functions for
// subpixel-accuracy stereo-vision systems (TIP 2012).
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "slam/frontend/disparity/disparity_volume.h"

namespace penumbra::slam {

struct DisparityChoice {
  double unique = 0.05;  // share
  int agree = 1;         // pixels
};

// S = down + up, of one size. `out`: pixels, kNoDisparity where there is none.
constexpr float kNoDisparity = 0.0F;
void choose_disparities(const DisparityVolume<std::int16_t>& down, const DisparityVolume<std::int16_t>& up,
                        const DisparityChoice& choice, FloatImage& out);

}  // namespace penumbra::slam
