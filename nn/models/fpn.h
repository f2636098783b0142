// Feature pyramid network over C2..C5, with mixed attention where the weights have it.
//
//   W_n  = SA(Conv1x1(C_n))                        lateral, spatial attention      docs/papers.md (1)
//   W'_n = CA(W_n)                                 channel attention               docs/papers.md (2)
//   T_n  = Upsample(T_{n+1}) + W'_n,  T_5 = W'_5   top-down                        docs/papers.md (3)
//   P_n  = Conv3x3(T_n),  n = 2..5;                P_6 = P_5 at every second pixel
//
// Without attention weights SA and CA are the identity: the plain FPN. All P_n have C channels, which the
// weights decide: 256 in torchvision's networks.
// Weights: fpn.inner_blocks.k.0 and fpn.layer_blocks.k.0 as torchvision; attention, ours, for level
// k = n - 2:
//   fpn.attention.k.spatial.weight [1, 2, 7, 7], fpn.attention.k.channel.reduce.weight [C/r, C],
//   fpn.attention.k.channel.expand.weight [C, C/r].
// Source: Lin et al. 2017; docs/papers.md A.1; torchvision.ops.FeaturePyramidNetwork.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "nn/layers/conv2d.h"
#include "nn/layers/mixed_attention.h"
#include "nn/models/weight_reader.h"

namespace penumbra::nn {

constexpr int kPyramidLevels = 5;  // P2..P6

class FeaturePyramid {
 public:
  FeaturePyramid() = default;
  // `stage_channels` are those of C2..C5. `attention` false leaves out the attention that the weights may
  // have. Throws InputError unless the number of channels is a multiple of 16, at most 1024.
  FeaturePyramid(WeightReader& weights, const std::string& prefix, const std::array<int, 4>& stage_channels,
                 bool attention = true);

  int channels() const { return channels_; }
  bool has_attention() const { return levels_.front().attention.has_value(); }

  // Of the convolutions, for an image of height x width pixels at the network, multiples of 32.
  double multiply_adds(int height, int width) const;

  // In what C5 is best stored, which nothing else reads.
  Numbers input_numbers() const { return levels_.back().lateral.input_numbers(); }

  // C2..C5 to P2..P6, each with a border of 1 for the 3 x 3 convolutions that read them, in `output_numbers`
  // where these layers can store them (conv2d.h: on a tile unit, and bf16 of Winograd's on AVX-512), else in
  // f32. Gives a stage's memory back when its lateral convolution has read it.
  std::array<FeatureMap, kPyramidLevels> operator()(std::array<FeatureMap, 4> stages, Arena& arena,
                                                    const Numbers& output_numbers = {}) const;

 private:
  struct Level {
    Conv2d lateral, output;
    std::optional<MixedAttention> attention;
  };
  int channels_ = 0;
  std::array<Level, 4> levels_;
};

}  // namespace penumbra::nn
