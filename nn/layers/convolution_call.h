// What the loop nests that compute a convolution are told, whichever of them does it.
#pragma once

#include <cstddef>

#include "nn/layers/activations.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct ConvolutionCall {
  // From the pixel of a group's first block on: in values, on a tile unit in bytes.
  const std::ptrdiff_t* taps = nullptr;
  int stride = 1, padding = 0;  // of the input
  Activation activation = Activation::none;
  float slope = kDefaultSlope;
  const FeatureMap* input = nullptr;
  const FeatureMap* residual = nullptr;  // null for none
  FeatureMap* output = nullptr;
};

}  // namespace penumbra::nn
