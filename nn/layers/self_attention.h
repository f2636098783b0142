// Self-attention over the pixels of a map, in the form of SAGAN: every pixel looks at every other one.
//
//   f = W_f x + b_f,  g = W_g x + b_g,  h = W_h x + b_h        1 x 1 convolutions    docs/papers.md (13)
//   beta[j, i] = softmax_i( f[:, i] . g[:, j] )      how much j looks at i           docs/papers.md (14)
//   o[:, j] = sum_i beta[j, i] h[:, i]                                               docs/papers.md (15)
//   y = gamma o + x                                  gamma is learned, 0 at first
//
// i and j run over the P = H W pixels.
// Shapes: x and y [N, C, H, W], W_f and W_g [D, C, 1, 1] (SAGAN: D = C / 8), W_h [C, C, 1, 1]. Where a
// network has SAGAN's last convolution W_v, W_h stands for the product W_v W_h.
// Cost: N P^2 (C + D) + N P C (C + 2 D) multiply-adds, and D P + P floats a thread of scratch.
// Source: Zhang et al. 2019, Self-Attention Generative Adversarial Networks, equations 1 to 3;
// reference/attention.cpp is the oracle.
#pragma once

#include <vector>

#include "nn/layers/conv2d.h"

namespace penumbra::nn {

struct SelfAttentionWeights {
  Tensor f, g, h;                             // as above
  std::vector<float> f_bias, g_bias, h_bias;  // empty for none
  float gamma = 0.0F;
};

class SelfAttention {
 public:
  SelfAttention() = default;
  // Throws InputError where the shapes do not fit together.
  explicit SelfAttention(const SelfAttentionWeights& weights);

  // x <- y
  void apply(FeatureMap& map, Arena& arena) const;

 private:
  Conv2d f_, g_, h_;
  float gamma_ = 0.0F;
};

}  // namespace penumbra::nn
