// Where a linear resize reads along one axis: the two input pixels around the place of an output pixel, and
// their weights in 2048ths, as in cv::resize(INTER_LINEAR):
//
//   x = (u + 1/2) step - 1/2,  step = extent / new extent;   low = floor(x),  high = low + 1
//
// both moved inside where they lie beyond the border.
#pragma once

#include <algorithm>
#include <cmath>

namespace penumbra {

struct LinearTap {
  static constexpr int kOne = 2048;  // the weight 1

  int low, high;
  int low_weight, high_weight;
};

// As OpenCV computes it: the inverse of a quotient.
inline double linear_step(int extent, int new_extent) {
  return 1.0 / (static_cast<double>(new_extent) / extent);
}

inline LinearTap linear_tap(int u, double step, int extent) {
  const auto x = static_cast<float>((u + 0.5) * step - 0.5);
  const int low = static_cast<int>(std::floor(x));
  const float share = x - static_cast<float>(low);
  const auto weight = [](float w) { return static_cast<int>(std::lrint(w * float{LinearTap::kOne})); };
  const auto inside = [extent](int pixel) { return std::clamp(pixel, 0, extent - 1); };
  return {inside(low), inside(low + 1), weight(1.0F - share), weight(share)};
}

}  // namespace penumbra
