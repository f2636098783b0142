#include "nn/layers/packed_weights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <new>

#include "nn/base/ceil_div.h"

namespace penumbra::nn {

namespace {

constexpr float kLargestWeight = 127.0F;  // of int8, both signs

const TileKernels* tile_kernels(Precision precision) {
  if (precision == Precision::f32) return kernels().tile;
  require(precision);
  return &low_precision_kernels(precision).tile;
}

// The nearest bf16; of two equally near, the one whose last bit is 0.
std::uint16_t to_bf16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<std::uint16_t>((bits + 0x7FFFU + ((bits >> 16) & 1U)) >> 16);
}

}  // namespace

void PackedWeights::Free::operator()(std::byte* data) const { std::free(data); }

PackedWeights::PackedWeights(int outputs, int taps, int depth,
                             const std::function<float(int, int, int)>& weight,
                             const std::vector<float>& bias, const NumberFormat& format)
    : kernels_(tile_kernels(format.precision)),
      format_(format),
      outputs_(outputs),
      taps_(taps),
      depth_(depth) {
  const int padded = ceil_div(outputs, kBlock) * kBlock;
  const int width = kernels_->channels, group = channel_group(format.precision);
  tiles_ = ceil_div(padded, width);
  const std::size_t row = static_cast<std::size_t>(taps) * depth;  // weights of one output channel
  const std::size_t bytes = static_cast<std::size_t>(padded) * row * element_size(format.precision);
  weights_.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes + 63) / 64 * 64 + 64)));
  if (weights_ == nullptr) throw std::bad_alloc();
  bias_.assign(static_cast<std::size_t>(padded), 0.0F);
  std::copy(bias.begin(), bias.end(), bias_.begin());

  std::vector<float> factor(static_cast<std::size_t>(padded), 1.0F);  // 1 / s_o
  if (format.precision == Precision::int8) {
    scale_.assign(static_cast<std::size_t>(padded), 0.0F);
    for (int o = 0; o < outputs; ++o) {
      float largest = 0.0F;
      for (int t = 0; t < taps; ++t) {
        for (int c = 0; c < depth; ++c) largest = std::max(largest, std::abs(weight(o, t, c)));
      }
      if (!(largest > 0.0F)) continue;
      factor[static_cast<std::size_t>(o)] = kLargestWeight / largest;
      scale_[static_cast<std::size_t>(o)] = format.input.scale * largest / kLargestWeight;
    }
  }

  std::vector<double> sum(static_cast<std::size_t>(padded), 0.0);  // of the whole-number weights
  std::byte* next = weights_.get();
  const auto put = [&](int o, int t, int c) {
    const float w = o < outputs ? weight(o, t, c) : 0.0F;
    const auto channel = static_cast<std::size_t>(o);
    switch (format.precision) {
      case Precision::f32:
        *reinterpret_cast<float*>(next) = w;
        break;
      case Precision::bf16:
        *reinterpret_cast<std::uint16_t*>(next) = to_bf16(w);
        break;
      case Precision::int8: {
        const float q = std::clamp(std::nearbyint(w * factor[channel]), -kLargestWeight, kLargestWeight);
        sum[channel] += q;
        *reinterpret_cast<std::int8_t*>(next) = static_cast<std::int8_t>(q);
        break;
      }
    }
    next += element_size(format.precision);
  };
  for (int first = 0; first < padded; first += width) {
    const int end = std::min(first + width, padded);
    for (int t = 0; t < taps; ++t) {
      for (int c = 0; c < depth; c += group) {
        for (int o = first; o < end; ++o) {
          for (int g = 0; g < group; ++g) put(o, t, c + g);
        }
      }
    }
  }
  for (std::size_t o = 0; o < scale_.size(); ++o) {
    bias_[o] -= static_cast<float>(static_cast<double>(scale_[o]) * format.input.zero * sum[o]);
  }
}

WeightTile PackedWeights::tile(int t) const {
  const int first = t * kernels_->channels;
  const std::size_t row = static_cast<std::size_t>(taps_) * depth_ * element_size(format_.precision);
  return {weights_.get() + static_cast<std::size_t>(first) * row,
          scale_.empty() ? nullptr : scale_.data() + first,
          bias_.data() + first,
          first / kBlock,
          first % kBlock,
          std::min(kernels_->channels, static_cast<int>(bias_.size()) - first)};
}

void PackedWeights::prepare(const WeightTile& tile, int first_tap, int tap_count,
                            TileArguments& arguments) const {
  arguments.tap_count = tap_count;
  arguments.depth = depth_;
  arguments.weights = tile.weights + static_cast<std::ptrdiff_t>(first_tap) * depth_ * tile.channels *
                                         element_size(format_.precision);
  arguments.scale = tile.scale;
  arguments.bias = tile.bias;
}

}  // namespace penumbra::nn
