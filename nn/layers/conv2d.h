// 2D convolution with its epilogue (bias, residual, activation) in one pass.
//
//   y[n, o, i, j] = act( b[o] + r[n, o, i, j]
//                        + sum_{k, u, v} w[o, k, u, v] x[n, g C/G + k, i s - p + u d, j s - p + v d] )
//   k < C/G,  g = o div (O/G): the group of output channel o
//   H_out = floor((H + 2 p - d (K - 1) - 1) / s) + 1, the same for W
//   stride s, zero padding p, dilation d, groups G (C groups of one channel: depthwise)
//
// Shapes: x [N, C, H, W], w [O, C/G, K_h, K_w], y and r [N, O, H_out, W_out].
// Cost: N O H_out W_out C/G K_h K_w multiply-adds (C rounded up to the input's block: 16, or 4 for images).
// Method: x's border serves as the zero padding and so must be at least p wide (a copy is made where it is
// not); then one of
//   winograd.h            3 x 3 of stride 1, where it pays
//   tile_convolution.h    everything in bf16 or 8 bits, on a processor with a tile unit: the maps that it
//                         reads and writes may be narrow, too (others are converted)
//   direct_convolution.h  everything else, on the register tile; where the output is one pixel an image
//                         (fully connected layers), the images take the place of the pixels
//   narrow_groups.h       groups that are no whole blocks of 16 channels
// The result does not depend on the number of threads.
// Source: torch.nn.Conv2d (cross-correlation); reference/convolution.cpp is the oracle.
#pragma once

#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/narrow_groups.h"
#include "nn/layers/packed_weights.h"
#include "nn/layers/winograd.h"
#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

struct Conv2dOptions {
  int stride = 1;
  int padding = 0;
  int dilation = 1;
  int groups = 1;
  Activation activation = Activation::none;
  float slope = kDefaultSlope;  // of leaky_relu
  bool winograd = true;         // false: never, as benchmarks and tests ask
  NumberFormat format;          // of the products; see winograd.h for what it makes of int8.
                                // Groups are computed in f32 on a tile unit
};

class Conv2d {
 public:
  Conv2d() = default;
  // `bias` is empty for none. `input_block` is the block of the maps that it will read. Throws InputError
  // where the weight is not of rank 4, the bias is not one value an output channel or the groups do not
  // divide the output channels.
  Conv2d(const Tensor& weight, const std::vector<float>& bias, Conv2dOptions options,
         int input_block = kBlock);

  // `residual` (null for none) has the output's shape. The output gets a zero border of `output_border`
  // pixels, and is stored in `output_numbers` where the layer can: on a tile unit any, Winograd's on AVX-512
  // bf16; else in f32. Maps are read in any numbers.
  FeatureMap operator()(const FeatureMap& input, Arena& arena, int output_border = 0,
                        const FeatureMap* residual = nullptr, const Numbers& output_numbers = {}) const;
  // The last reader of `input`: where its values are converted first, the map gives its memory back.
  FeatureMap operator()(FeatureMap&& input, Arena& arena, int output_border = 0,
                        const FeatureMap* residual = nullptr, const Numbers& output_numbers = {}) const;
  // The last reader of the residual, whose memory the output takes where it is laid out alike; not on a tile
  // unit, nor in narrow groups, nor where the output is one pixel an image.
  FeatureMap onto(FeatureMap residual, const FeatureMap& input, Arena& arena, int output_border = 0,
                  const Numbers& output_numbers = {}) const;
  // And of the input.
  FeatureMap onto(FeatureMap residual, FeatureMap&& input, Arena& arena, int output_border = 0,
                  const Numbers& output_numbers = {}) const;
  // What a call computes of the weights alone (winograd.h), for several calls: `prepared` of the call below.
  ArenaBuffer prepare(Arena& arena) const;
  FeatureMap operator()(const FeatureMap& input, Arena& arena, const ArenaBuffer& prepared,
                        int output_border = 0, const FeatureMap* residual = nullptr,
                        const Numbers& output_numbers = {}) const;

  // In what the map that it reads is best stored: f32 but on a tile unit, though there of images, too, and
  // where Winograd's products are bf16.
  Numbers input_numbers() const {
    if (!winograd_.empty()) return winograd_.input_numbers();
    return on_tiles_ && input_block_ == kBlock ? numbers_of(options_.format) : Numbers{};
  }

  int output_channels() const { return outputs_; }
  // How it is computed: on "tiles", by "winograd", "direct" or in "narrow" groups.
  const char* algorithm() const {
    if (on_tiles_) return "tiles";
    if (!winograd_.empty()) return "winograd";
    return groups_.empty() ? "narrow" : "direct";
  }
  // Multiply-adds for an input of height x width pixels, counted without the padding of channels to blocks.
  double multiply_adds(int height, int width) const;

 private:
  struct Geometry {
    int height, width;  // of the output
  };
  // What a call is given. `last` is the input where nobody reads it afterwards, `under` the residual
  // likewise.
  struct Call {
    Arena& arena;
    const ArenaBuffer& prepared;
    int output_border = 0;
    Numbers output_numbers;
    FeatureMap* last = nullptr;
    FeatureMap* under = nullptr;
  };
  FeatureMap run(const FeatureMap& input, const FeatureMap* residual, const Call& call) const;
  bool reads(const Numbers& numbers) const;
  Numbers stores(const Numbers& wanted) const;
  Geometry output_size(int height, int width) const;
  int tap_depth() const;        // channels of the input that a tap has
  int split_row_lines() const;  // that a kernel row of a split image fills
  void pack_image_weights(const Tensor& weight, const std::vector<float>& bias);
  void pack_split_weights(const Tensor& weight, const std::vector<float>& bias);
  void pack_weights(const Tensor& weight, const std::vector<float>& bias);
  void direct(const FeatureMap& input, const ArenaBuffer& converted, const FeatureMap* residual,
              FeatureMap& output, Arena& arena) const;
  void over_rows(const FeatureMap& input, const FeatureMap* residual, FeatureMap& output) const;

  Conv2dOptions options_;
  int input_channels_ = 0, outputs_ = 0, kernel_height_ = 0, kernel_width_ = 0, input_block_ = kBlock;
  bool on_tiles_ = false;
  // One of these holds the weights.
  Winograd winograd_;
  std::vector<PackedWeights> groups_;  // one a group
  NarrowGroups narrow_;
};

// A fully connected layer y = W x + b over maps [N, C, H, W] is the convolution whose kernel is the whole
// map: `weight` [O, C H W] in torch.flatten's order (channel, row, column). Its output is [N, O, 1, 1].
Conv2d linear(Tensor weight, const std::vector<float>& bias, int channels, int height, int width,
              Activation activation, const NumberFormat& format = {});

}  // namespace penumbra::nn
