// Transposed convolution whose stride equals its kernel (no overlaps), as in the mask head: 2 x 2, stride 2.
//
//   y[n, o, s i + u, s j + v] = act( b[o] + sum_c w[c, o, u, v] x[n, c, i, j] ),   u, v in 0..s-1
//
// Shapes: x [N, C, H, W], w [C, O, s, s], y [N, O, s H, s W]. Cost: N O C s^2 H W multiply-adds.
// Method: s^2 pointwise convolutions, each writing every s-th pixel of every s-th row.
// Source: torch.nn.ConvTranspose2d; reference/conv_transpose2d.cpp is the oracle.
#pragma once

#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/packed_weights.h"
#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class ConvTranspose2d {
 public:
  ConvTranspose2d() = default;
  // Throws InputError where the weight is not [C, O, s, s] or the bias is not one value an output channel.
  ConvTranspose2d(const Tensor& weight, const std::vector<float>& bias, Activation activation);

  FeatureMap operator()(const FeatureMap& input, Arena& arena, int output_border = 0) const;

 private:
  Activation activation_ = Activation::none;
  int input_channels_ = 0, stride_ = 0;
  std::vector<PackedWeights> positions_;  // one a kernel position, row by row
};

}  // namespace penumbra::nn
