// Scalar activation functions and softmax, for the small tensors at the heads of a network.
//
//   sigmoid(x) = 1 / (1 + exp(-x))          softmax(x)_i = exp(x_i - max x) / sum_j exp(x_j - max x)
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace penumbra::nn {

inline float sigmoid(float x) { return 1.0F / (1.0F + std::exp(-x)); }

// In place; the shift by the maximum keeps exp from overflowing.
inline void softmax(std::span<float> x) {
  if (x.empty()) return;
  const float top = *std::max_element(x.begin(), x.end());
  float sum = 0.0F;
  for (float& value : x) sum += value = std::exp(value - top);
  for (float& value : x) value /= sum;
}

}  // namespace penumbra::nn
