// The sums of a grouped convolution whose groups are no whole blocks of 16 channels; depthwise ones first of
// all.
//
//   y[n, o, i, j] = b[o] + sum_{k, u, v} w[o, k, u, v] x[n, g C/G + k, i s - p + u d, j s - p + v d]
//
// The letters are those of conv2d.h; Conv2d comes here where the tile kernel does not fit.
// Cost: N O H_out W_out C/G K_h K_w multiply-adds, O rounded up to 16.
// Method: a weight at a time over a row of 16 output channels, which stays in L1; depthwise rows read 16
// neighbouring channels at once, others gather them.
// Source: torch.nn.Conv2d(groups).
#pragma once

#include <vector>

#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class NarrowGroups {
 public:
  NarrowGroups() = default;
  // `weight` is [O, C/G, K_h, K_w], `bias` empty or one value an output channel.
  NarrowGroups(const Tensor& weight, const std::vector<float>& bias, int groups);

  // One row of a block of 16 output channels. `input`'s border is at least the padding.
  void row(const FeatureMap& input, int stride, int padding, int dilation, int n, int block, int y,
           FeatureMap& output) const;

 private:
  int group_inputs_ = 0, group_outputs_ = 0, kernel_height_ = 0, kernel_width_ = 0;
  std::vector<float> weights_;  // [block][k][u][v][16]
  std::vector<float> bias_;     // [block][16]
};

}  // namespace penumbra::nn
