// Adaptively spatial feature fusion: several levels of a pyramid, mixed at every pixel by learned shares.
//
//   lambda_k[i, j] = w_k . F_k[:, i, j] + b_k                  a 1 x 1 convolution C -> 1 a level
//   (alpha_1, ..., alpha_K)[i, j] = softmax_k( lambda_k[i, j] )
//   y[c, i, j] = sum_k alpha_k[i, j] F_k[c, i, j]              docs/papers.md B.1, there K = 3
//
// The F_k are the levels already resized to one of them (pooling.h, strided convolutions); the shares of a
// pixel are positive and add up to 1. Levels that are coarser by a whole factor r are given as they are and
// repeated in passing, F_k[c, i / r, j / r]: their lambda is computed once a pixel of theirs.
// Shapes: y [N, C, H, W], H and W the largest of all levels'; F_k [N, C, H / r_k, W / r_k].
// Cost: 2 K C multiply-adds a pixel; every F_k is read twice, the second time from the cache. A row at a time
// by the kernel mix_row. Source: Liu et al. 2019, Learning Spatial Fusion for Single-Shot Object Detection,
// equations 1 and 2; reference/attention.cpp is the oracle.
#pragma once

#include <span>
#include <vector>

#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class Asff {
 public:
  Asff() = default;
  // `weights` holds w_1, w_2, ..., each [1, C, 1, 1]; `bias` holds b_1, b_2, ... or is empty for none. Throws
  // InputError where they do not fit together.
  Asff(std::span<const Tensor> weights, std::vector<float> bias);

  // One map a level. Throws InputError where their shapes do not fit together.
  FeatureMap operator()(std::span<const FeatureMap* const> levels, Arena& arena, int output_border = 0) const;

 private:
  int channels_ = 0;
  std::size_t level_count_ = 0;
  std::vector<float> weights_;  // [level][C rounded up to 16], zero beyond C
  std::vector<float> bias_;     // [level]
};

}  // namespace penumbra::nn
