#include "nn/layers/conv_transpose2d.h"

#include <limits>

#include "nn/base/error.h"

namespace penumbra::nn {

ConvTranspose2d::ConvTranspose2d(const Tensor& weight, const std::vector<float>& bias, Activation activation)
    : activation_(activation) {
  if (weight.shape.size() != 4 || weight.extent(2) != weight.extent(3)) {
    throw InputError("conv_transpose2d", "a weight [C, O, s, s]", to_string(weight.shape));
  }
  input_channels_ = static_cast<int>(weight.extent(0));
  const int outputs = static_cast<int>(weight.extent(1));
  stride_ = static_cast<int>(weight.extent(2));
  if (!bias.empty() && static_cast<int>(bias.size()) != outputs) {
    throw InputError("conv_transpose2d", fmt::format("{} biases", outputs), fmt::format("{}", bias.size()));
  }
  for (int u = 0; u < stride_; ++u) {
    for (int v = 0; v < stride_; ++v) {
      positions_.emplace_back(
          outputs, (input_channels_ + kBlock - 1) / kBlock, kBlock,
          [&](int o, int tap, int c) {
            const int channel = tap * kBlock + c;
            return channel < input_channels_ ? weight.at(channel, o, u, v) : 0.0F;
          },
          bias);
    }
  }
}

FeatureMap ConvTranspose2d::operator()(const FeatureMap& input, Arena& arena, int output_border) const {
  if (input.channels() != input_channels_ || input.block() != kBlock) {
    throw InputError("conv_transpose2d", fmt::format("{} input channels", input_channels_),
                     fmt::format("{}", input.channels()));
  }
  const int outputs = positions_.front().outputs(), tiles = positions_.front().tiles();
  FeatureMap output(arena, input.images(), outputs, input.height() * stride_, input.width() * stride_,
                    output_border);

  const int taps_needed = positions_.front().taps();
  const ArenaBuffer tap_memory = arena.allocate(static_cast<std::size_t>(taps_needed) * 2);
  auto* taps = reinterpret_cast<std::ptrdiff_t*>(tap_memory.data());
  for (int b = 0; b < taps_needed; ++b) taps[b] = b * input.block_stride();

  const int step = positions_.front().tile_pixels();
  const int segments = (input.width() + step - 1) / step;
#pragma omp parallel for collapse(3) schedule(dynamic)
  for (int n = 0; n < input.images(); ++n) {
    for (int position = 0; position < stride_ * stride_; ++position) {
      for (int t = 0; t < tiles; ++t) {
        const PackedWeights& weights = positions_[static_cast<std::size_t>(position)];
        const WeightTile tile = weights.tile(t);
        TileArguments a;
        a.input_pixel_stride = input.block();
        a.taps = taps;
        a.tap_count = taps_needed;
        a.depth = kBlock;
        a.weights = tile.weights;
        a.bias = tile.bias;
        a.output_pixel_stride = static_cast<std::ptrdiff_t>(stride_) * output.block();
        a.output_block_stride = output.block_stride();
        a.lower_bound = activation_ == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
        for (int y = 0; y < input.height(); ++y) {
          for (int s = 0; s < segments; ++s) {
            const int x = input.width() * s / segments, end = input.width() * (s + 1) / segments;
            a.input = input.pixel(n, 0, y, x);
            a.output = output.pixel(n, tile.block, y * stride_ + position / stride_,
                                    x * stride_ + position % stride_) +
                       tile.lane;
            weights.kernel(tile, end - x)(a);
          }
        }
      }
    }
  }
  return output;
}

}  // namespace penumbra::nn
