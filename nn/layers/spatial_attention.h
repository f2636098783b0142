// Spatial attention: where in the image to look.
//
//   A_s(F) = sigmoid( Conv7x7( [ max_c F ; mean_c F ] ) )  [N, 2, H, W] -> [N, 1, H, W]  docs/papers.md (4)
//   M_s(F) = A_s(F) (x) F                                  broadcast over the channels   docs/papers.md (5)
//
// The 7 x 7 convolution pads with 3 zeros and has no bias.
// Cost: 98 N H W multiply-adds for the convolution (as computed: 28 channels x 7 rows x 16 outputs), 2 reads
// and 1 write of F.
// Source: Woo et al. 2018, CBAM, equation 3; reference/attention.cpp is the oracle.
#pragma once

#include "nn/layers/conv2d.h"

namespace penumbra::nn {

class SpatialAttention {
 public:
  SpatialAttention() = default;
  // `weight` is [1, 2, K, K], K odd; channel 0 reads the maximum, channel 1 the mean.
  explicit SpatialAttention(const Tensor& weight);

  // F <- M_s(F)
  void apply(FeatureMap& map, Arena& arena) const;

 private:
  int padding_ = 0;
  Conv2d conv_;
};

}  // namespace penumbra::nn
