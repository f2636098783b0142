// The weights of winograd.h's layers: kept as they are, transformed for a call or some calls.
#include <algorithm>
#include <cstring>

#include "nn/base/ceil_div.h"
#include "nn/base/half.h"
#include "nn/base/parallel.h"
#include "nn/layers/winograd.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

bool winograd_pays(int channels, int outputs) {
  return channels >= 32 && outputs >= 32 && channels <= 384 && outputs <= 384;
}

Winograd::Winograd(const Tensor& weight, const std::vector<float>& bias, Precision precision) {
  const int outputs = static_cast<int>(weight.extent(0)), channels = static_cast<int>(weight.extent(1));
  input_blocks_ = ceil_div(channels, kBlock);
  output_blocks_ = ceil_div(outputs, kBlock);
  bias_.assign(static_cast<std::size_t>(output_blocks_) * kBlock, 0.0F);
  std::copy(bias.begin(), bias.end(), bias_.begin());
  layout_ = PackedWeights(outputs, input_blocks_, kBlock, NumberFormat{precision, {}, nullptr});
  const std::size_t row = static_cast<std::size_t>(input_blocks_) * kBlock * kWinogradKernel;  // of an output
  const auto value = static_cast<std::size_t>(element_size(precision));
  kernels_ = WeightMemory(bias_.size() * row * value);
  parallel_for(layout_.tiles(), 1, [&](int t) {
    const int first = t * layout_.tile_channels();
    const int width = std::min(layout_.tile_channels(), static_cast<int>(bias_.size()) - first);
    std::byte* const start = kernels_.data() + static_cast<std::size_t>(first) * row * value;
    std::memset(start, 0, row * static_cast<std::size_t>(width) * value);
    const std::ptrdiff_t numbers = std::ptrdiff_t{channels} * kWinogradKernel;
    const auto turn = [&](auto* out, auto stored) {
      for (std::ptrdiff_t i = 0; i < numbers; ++i, out += width) {
        const float* in = weight.values.data() + first * numbers + i;
        for (int o = 0; o < std::min(width, outputs - first); ++o) out[o] = stored(in[o * numbers]);
      }
    };
    if (precision == Precision::f32) {
      turn(reinterpret_cast<float*>(start), [](float weight) { return weight; });
    } else {
      turn(reinterpret_cast<std::uint16_t*>(start), f32_to_bf16);
    }
  });
}

Numbers Winograd::input_numbers() const {
  const bool narrow = layout_.format().precision == Precision::bf16 && line_kernels() != nullptr;
  return {narrow ? Precision::bf16 : Precision::f32, {}};
}

bool Winograd::stores(const Numbers& numbers) const {
  // A line of bf16 is two blocks.
  return numbers.precision == Precision::f32 || (numbers == input_numbers() && output_blocks_ % 2 == 0);
}

std::size_t Winograd::position_bytes() const {
  return layout_.bytes() + 64;  // so that positions do not share one set of the cache
}

ArenaBuffer Winograd::prepare(Arena& arena) const {
  const std::size_t stride = position_bytes();
  ArenaBuffer prepared = arena.allocate(stride / sizeof(float) * kWinogradPositions);
  auto* const start = reinterpret_cast<std::byte*>(prepared.data());
  const bool rounded = layout_.format().precision != Precision::f32;
  parallel_for({layout_.tiles(), input_blocks_}, 1, [&](int t, int tap) {
    const WeightTile tile = layout_.tile(t, start);
    // The tile's part of a position, in numbers from its start; of the kernels nine times as far.
    const std::ptrdiff_t place = (static_cast<std::ptrdiff_t>(t) * layout_.tile_channels() * input_blocks_ +
                                  static_cast<std::ptrdiff_t>(tap) * tile.channels) *
                                 kBlock;
    WinogradWeightArguments a;
    a.channels = tile.channels;
    if (!rounded) {
      a.input = reinterpret_cast<const float*>(kernels_.data()) + place * kWinogradKernel;
      a.output = prepared.data() + place;
      a.position_stride = static_cast<std::ptrdiff_t>(stride / sizeof(float));
      a.count = kBlock;
      return kernels().winograd_weights(a);
    }
    // Groups of channels side by side, as layout_ has them in bf16.
    constexpr int kMostGroup = 4;
    const int group = layout_.group();
    float kernels_of_one[kWinogradKernel * kMostTileChannels];
    float channels[kWinogradPositions][kMostGroup][kMostTileChannels];
    const auto* stored = reinterpret_cast<const std::uint16_t*>(kernels_.data()) + place * kWinogradKernel;
    a.input = kernels_of_one;
    a.position_stride = kMostGroup * kMostTileChannels;
    a.count = 1;
    const std::ptrdiff_t numbers = std::ptrdiff_t{kWinogradKernel} * tile.channels;
    for (int c = 0; c < kBlock; c += group) {
      for (int i = 0; i < group; ++i, stored += numbers) {
        for (std::ptrdiff_t k = 0; k < numbers; ++k) kernels_of_one[k] = bf16_to_f32(stored[k]);
        a.output = &channels[0][i][0];
        kernels().winograd_weights(a);
      }
      for (int k = 0; k < kWinogradPositions; ++k) {
        auto* out = reinterpret_cast<std::uint16_t*>(start + static_cast<std::size_t>(k) * stride) + place +
                    c * tile.channels;
        for (int o = 0; o < tile.channels; ++o) {
          for (int i = 0; i < group; ++i) *out++ = f32_to_bf16(channels[k][i][o]);
        }
      }
    }
  });
  return prepared;
}

}  // namespace penumbra::nn
