// Coordinate attention: which channels matter in which row and in which column.
//
//   z^h[c, i] = mean_j F[c, i, j]            z^w[c, j] = mean_i F[c, i, j]
//   f^h = hswish( BN(W z^h + b) )            f^w = hswish( BN(W z^w + b) )     one W: C -> M
//   g^h = sigmoid( W_h f^h + b_h )           g^w = sigmoid( W_w f^w + b_w )    M -> C
//   M(F)[c, i, j] = F[c, i, j] g^h[c, i] g^w[c, j]                             docs/papers.md B.1
//
// The paper joins z^h and z^w along their length before W and splits f behind it; a 1 x 1 convolution treats
// every position alone, so here each goes through W by itself. BN is folded into W and b (batch_norm.h).
// Inside a residual unit the shortcut x is added by the pass that multiplies: y = x + M(F).
// Shapes: F, x [N, C, H, W], in place.
// Cost: 3 C M (H + W) multiply-adds an image, 2 reads and 1 write of F (the second read and the write are
// those that the addition of a shortcut takes anyway). Source: Hou et al. 2021, Coordinate Attention for
// Efficient Mobile Network Design, equations 4 to 8; reference/attention.cpp is the oracle.
#pragma once

#include <vector>

#include "nn/layers/conv2d.h"

namespace penumbra::nn {

struct CoordinateAttentionWeights {
  Tensor squeeze;                       // W [M, C, 1, 1], batch norm folded in
  std::vector<float> squeeze_bias;      // [M]; the biases may be empty
  Tensor expand_rows;                   // W_h [C, M, 1, 1]
  std::vector<float> expand_rows_bias;  // [C]
  Tensor expand_columns;                // W_w [C, M, 1, 1]
  std::vector<float> expand_columns_bias;
};

class CoordinateAttention {
 public:
  CoordinateAttention() = default;
  // Throws InputError where the shapes do not fit together.
  explicit CoordinateAttention(const CoordinateAttentionWeights& weights);

  // F <- M(F), or x + M(F) with `shortcut` x, a map of F's shape.
  void apply(FeatureMap& map, Arena& arena, const FeatureMap* shortcut = nullptr) const;

 private:
  Conv2d squeeze_, expand_rows_, expand_columns_;
};

}  // namespace penumbra::nn
