// Activation functions: of one number, of a vector and, in place, of every pixel of a feature map.
//
//   relu(x)         = max(x, 0)
//   leaky_relu(x)   = x where x > 0, else slope x
//   sigmoid(x)      = 1 / (1 + exp(-x))
//   silu(x)         = x sigmoid(x)                        (also called swish)
//   hard_sigmoid(x) = min(max(x + 3, 0), 6) / 6
//   hard_swish(x)   = x hard_sigmoid(x)
//   softmax(x)_i    = exp(x_i - max x) / sum_j exp(x_j - max x)
//
// Shapes: any; softmax of a map is over its channels, pixel by pixel.
// Cost: one read and one write of the map, 2 to 20 operations a value. A map's border keeps its zeros, NaN
// stays NaN.
// Source: torch.nn.functional; Elfwing et al. 2017 (silu); Howard et al. 2019, MobileNetV3, section 5.2
// (hard_sigmoid, hard_swish); reference/elementwise.cpp is the oracle.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "nn/simd/activation_kind.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

constexpr float kDefaultSlope = 0.01F;  // of leaky_relu below 0, PyTorch's

inline float sigmoid(float x) { return 1.0F / (1.0F + std::exp(-x)); }

// In place; the shift by the maximum keeps exp from overflowing.
inline void softmax(std::span<float> x) {
  if (x.empty()) return;
  const float top = *std::max_element(x.begin(), x.end());
  float sum = 0.0F;
  for (float& value : x) sum += value = std::exp(value - top);
  for (float& value : x) value /= sum;
}

// In place, `count` values; `slope` is read by leaky_relu alone.
void activate(float* values, std::ptrdiff_t count, Activation activation, float slope = kDefaultSlope);

// In place, every pixel.
void activate(FeatureMap& map, Activation activation, float slope = kDefaultSlope);
inline void relu(FeatureMap& map) { activate(map, Activation::relu); }
inline void leaky_relu(FeatureMap& map, float slope) { activate(map, Activation::leaky_relu, slope); }
inline void sigmoid(FeatureMap& map) { activate(map, Activation::sigmoid); }
inline void silu(FeatureMap& map) { activate(map, Activation::silu); }
inline void hard_sigmoid(FeatureMap& map) { activate(map, Activation::hard_sigmoid); }
inline void hard_swish(FeatureMap& map) { activate(map, Activation::hard_swish); }

// In place, over the channels of every pixel.
void softmax_channels(FeatureMap& map);

}  // namespace penumbra::nn
