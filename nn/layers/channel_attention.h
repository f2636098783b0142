// Channel attention: which channels matter for this image.
//
//   A_c(F) = sigmoid( MLP(max_hw F) + MLP(mean_hw F) )       [N, C, 1, 1]               docs/papers.md (6)
//   MLP(v) = W_2 relu(W_1 v)
//   M_c(F) = A_c(F) (x) F                                    broadcast over the pixels  docs/papers.md (7)
//
// W_1 is [C/r, C], W_2 [C, C/r], both without bias; Penumbra's r is 16.
// Cost: 4 C^2 / r multiply-adds an image, 2 reads and 1 write of F.
// Source: Woo et al. 2018, CBAM, equation 2; reference/attention.cpp is the oracle.
#pragma once

#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class ChannelAttention {
 public:
  ChannelAttention() = default;
  // `reduce` is W_1, `expand` is W_2; both rank 2.
  ChannelAttention(Tensor reduce, Tensor expand);

  // F <- M_c(F)
  void apply(FeatureMap& map, Arena& arena) const;

 private:
  Tensor reduce_, expand_;
};

}  // namespace penumbra::nn
