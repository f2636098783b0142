// Batch normalisation at inference, folded into the convolution before it.
//
//   y = gamma (z - mean) / sqrt(var + eps) + beta,  z = W * x   ==>   W'[o] = a[o] W[o],  b'[o] = beta - a[o]
//   mean, a = gamma / sqrt(var + eps)
//
// eps is 1e-5 in PyTorch; torchvision's released COCO_V1 detection checkpoints were trained with 0.
// Source: Ioffe and Szegedy 2015, equation in algorithm 1; torchvision.ops.misc.FrozenBatchNorm2d.
#pragma once

#include <vector>

#include "nn/tensor/tensor.h"

namespace penumbra::nn {

struct BatchNorm {
  std::vector<float> gamma, beta, mean, variance;  // one value a channel
  float eps = 1e-5F;
};

struct FoldedConvolution {
  Tensor weight;            // [O, C, K, K]
  std::vector<float> bias;  // [O]
};

// `weight` is [O, C, K, K]; every vector of `norm` has O values.
FoldedConvolution fold_batch_norm(Tensor weight, const BatchNorm& norm);

}  // namespace penumbra::nn
