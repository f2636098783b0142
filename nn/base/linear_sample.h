// Where linear interpolation reads along one axis: two neighbouring elements and the second one's weight.
//
//   value at p = (1 - f) x[low] + f x[high],  low = floor(p), f = p - low;   p is clamped to the first
//   element below, and elements beyond the last are the last
//
// half_pixel gives the position p that element i of a resized axis has on the original: pixel centres lie at
// halves,
//   p = (i + 1/2) scale - 1/2,   scale = original extent / new extent
// Source: torch.nn.functional.interpolate with align_corners false, in f32 as it computes.
#pragma once

#include <algorithm>

namespace penumbra::nn {

struct LinearSample {
  int low, high;
  float fraction;
};

inline LinearSample linear_sample(float position, int extent) {
  position = std::max(0.0F, position);  // in this order NaN becomes 0
  const int low = std::min(static_cast<int>(position), extent - 1);
  return {low, std::min(low + 1, extent - 1), position - static_cast<float>(low)};
}

inline float half_pixel(int i, float scale) { return (static_cast<float>(i) + 0.5F) * scale - 0.5F; }

}  // namespace penumbra::nn
