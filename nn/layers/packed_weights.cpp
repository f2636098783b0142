#include "nn/layers/packed_weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "nn/base/ceil_div.h"
#include "nn/base/half.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

constexpr float kLargestWeight = 127.0F;  // of int8, both signs

const TileKernels* tile_kernels(Precision precision) {
  if (precision == Precision::f32) return kernels().tile;
  require(precision);
  return &low_precision_kernels(precision).tile;
}

// The nearest whole number, of two equally near the even one, for |value| < 2^22.
float nearest(float value) {
  constexpr float kShift = 0x1.8p23F;
  return (value + kShift) - kShift;
}

constexpr int kColumns = 16;  // of the source that are turned at a time

// columns[o][j] = the weight of output channel first + o at offset j, for the `count` offsets from `offset`
// on.
void read_columns(const WeightSource& source, int first, int channels, const std::ptrdiff_t* offset,
                  int count, float (*columns)[kColumns]) {
  bool side_by_side = count == kColumns && offset[0] != WeightSource::kNone;
  for (int j = 1; j < count; ++j) side_by_side = side_by_side && offset[j] == offset[0] + j;
  for (int o = 0; o < channels; ++o) {
    const float* row = source.values + (first + o) * source.output_stride;
    if (side_by_side) {
      std::memcpy(columns[o], row + offset[0], kColumns * sizeof(float));
      continue;
    }
    for (int j = 0; j < count; ++j) columns[o][j] = offset[j] == WeightSource::kNone ? 0.0F : row[offset[j]];
  }
}

}  // namespace

PackedWeights::PackedWeights(int outputs, int taps, int depth, const NumberFormat& format)
    : kernels_(tile_kernels(format.precision)),
      format_(format),
      outputs_(outputs),
      taps_(taps),
      depth_(depth) {
  const int padded = ceil_div(outputs, kBlock) * kBlock;
  tiles_ = ceil_div(padded, kernels_->channels);
  bias_.assign(static_cast<std::size_t>(padded), 0.0F);
}

PackedWeights::PackedWeights(int outputs, int taps, int depth, const WeightSource& source,
                             const std::vector<float>& bias, const NumberFormat& format)
    : PackedWeights(outputs, taps, depth, format) {
  const std::size_t padded = bias_.size();
  const std::size_t row = static_cast<std::size_t>(taps) * static_cast<std::size_t>(depth);
  weights_ = WeightMemory(bytes());
  std::copy(bias.begin(), bias.end(), bias_.begin());

  std::vector<float> factor(padded, 1.0F);  // 1 / s_o
  if (format.precision == Precision::int8) {
    scale_.assign(padded, 0.0F);
    parallel_for(outputs, grain_of(static_cast<std::int64_t>(row)), [&](int channel) {
      const float* values = source.values + channel * source.output_stride;
      float largest = 0.0F;
      for (const std::ptrdiff_t offset : source.offsets) {
        if (offset != WeightSource::kNone) largest = std::max(largest, std::abs(values[offset]));
      }
      if (!(largest > 0.0F)) return;
      factor[static_cast<std::size_t>(channel)] = kLargestWeight / largest;
      scale_[static_cast<std::size_t>(channel)] = format.input.scale * largest / kLargestWeight;
    });
  }
  std::vector<double> sums(padded, 0.0);  // of the whole-number weights
  pack(source, factor, sums);
  for (std::size_t o = 0; o < scale_.size(); ++o) {
    const int zero = format.input.zero - kernels_->input_offset;
    bias_[o] -= static_cast<float>(static_cast<double>(scale_[o]) * zero * sums[o]);
  }
}

void PackedWeights::pack(const WeightSource& source, const std::vector<float>& factor,
                         std::vector<double>& sums) {
  const int width = kernels_->channels, group = this->group();
  const int row = taps_ * depth_, padded = static_cast<int>(bias_.size());
  parallel_for(tiles_, grain_of(std::int64_t{width} * row), [&](int tile) {
    float columns[kMostTileChannels][kColumns];
    const int first = tile * width, channels = std::min(width, padded - first);
    const int known = std::clamp(outputs_ - first, 0, channels);  // the others are 0
    std::fill_n(&columns[0][0], kMostTileChannels * kColumns, 0.0F);
    std::byte* const start = weights_.data() + static_cast<std::size_t>(first) *
                                                   static_cast<std::size_t>(row) *
                                                   static_cast<std::size_t>(element_size(format_.precision));
    for (int k = 0; k < row; k += kColumns) {
      const int count = std::min(kColumns, row - k);
      read_columns(source, first, known, source.offsets.data() + k, count, columns);
      // Number i of a group of channels of output o, from column j on.
      const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(k) * channels;
      switch (format_.precision) {
        case Precision::f32: {
          float* out = reinterpret_cast<float*>(start) + place;
          for (int j = 0; j < count; ++j, out += channels) {
            for (int o = 0; o < channels; ++o) out[o] = columns[o][j];
          }
          break;
        }
        case Precision::bf16: {
          std::uint16_t* out = reinterpret_cast<std::uint16_t*>(start) + place;
          for (int j = 0; j < count; j += group) {
            for (int o = 0; o < channels; ++o) {
              for (int i = 0; i < group; ++i) *out++ = f32_to_bf16(columns[o][j + i]);
            }
          }
          break;
        }
        case Precision::int8: {
          std::int8_t* out = reinterpret_cast<std::int8_t*>(start) + place;
          for (int j = 0; j < count; j += group) {
            for (int o = 0; o < channels; ++o) {
              const auto channel = static_cast<std::size_t>(first + o);
              for (int i = 0; i < group; ++i) {
                const float q =
                    std::clamp(nearest(columns[o][j + i] * factor[channel]), -kLargestWeight, kLargestWeight);
                sums[channel] += static_cast<double>(q);
                *out++ = static_cast<std::int8_t>(q);
              }
            }
          }
          break;
        }
      }
    }
  });
}

std::size_t PackedWeights::bytes() const {
  return bias_.size() * static_cast<std::size_t>(taps_) * static_cast<std::size_t>(depth_) *
         static_cast<std::size_t>(element_size(format_.precision));
}

WeightTile PackedWeights::tile(int t, const std::byte* weights) const {
  const int first = t * kernels_->channels;
  const std::size_t row = static_cast<std::size_t>(taps_) * depth_ * element_size(format_.precision);
  return {weights + static_cast<std::size_t>(first) * row,
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
