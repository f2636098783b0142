// Weights in the order in which the register-tile kernel reads them: [tile][tap][depth / g][V][g], where V is
// the tile's output channels (32, 16 or 8 by instruction set; the last tile may be a narrow one of 16) and g
// the channels that one instruction adds up (1 of f32, 2 or 4 of bf16, 4 or 8 of int8). Output channels are
// padded with zeros to whole blocks of 16. See nn/simd/kernel_table.h.
//
// In int8 every output channel o has a scale of its own, s_o = max |w_o| / 127, and inputs are
// x = s (q - zero). With whole numbers q and q_w the tile computes s s_o sum q q_w; what the zero adds to
// that, -s s_o zero sum q_w, is part of the bias.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nn/layers/number_format.h"
#include "nn/layers/weight_memory.h"
#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

constexpr int kMostTileChannels = 32;  // V of the widest tile

// One tile's part of the packed weights and where its channels lie in a channel-blocked output.
struct WeightTile {
  const std::byte* weights;  // [tap][depth / g][V][g]
  const float* scale;        // [V] in int8, else null
  const float* bias;         // [V]
  int block;                 // block of the first output channel
  int lane;                  // its place in the block
  int channels;              // V, or 16 in a narrow tile
};

// Where weights lie in a tensor: that of output channel o, tap t and channel c of the tap is
// values[o * output_stride + offsets[t * depth + c]], and 0 where that offset is kNone.
struct WeightSource {
  static constexpr std::ptrdiff_t kNone = -1;
  const float* values = nullptr;
  std::ptrdiff_t output_stride = 0;
  std::vector<std::ptrdiff_t> offsets;  // [taps * depth]
};

class PackedWeights {
 public:
  PackedWeights() = default;
  // `source` is read now; `bias` has one value an output channel or is empty for none. `depth` must be a
  // multiple of 16 bytes. Threads share the work, which takes about as long as copying the weights.
  PackedWeights(int outputs, int taps, int depth, const WeightSource& source, const std::vector<float>& bias,
                const NumberFormat& format = {});
  // The layout alone, of weights that lie elsewhere; no biases.
  PackedWeights(int outputs, int taps, int depth, const NumberFormat& format);

  int outputs() const { return outputs_; }
  int taps() const { return taps_; }
  int depth() const { return depth_; }
  int tiles() const { return tiles_; }
  int tile_pixels() const { return kernels_->pixels; }
  int tile_channels() const { return kernels_->channels; }
  int group() const { return kernels_->group_bytes / element_size(format_.precision); }  // g
  const NumberFormat& format() const { return format_; }

  std::size_t bytes() const;  // of all tiles

  WeightTile tile(int t) const { return tile(t, weights_.data()); }
  WeightTile tile(int t, const std::byte* weights) const;  // of weights that begin there
  // The arguments that are the same for all pixels, for `tap_count` taps from `first_tap` on.
  void prepare(const WeightTile& tile, int first_tap, int tap_count, TileArguments& arguments) const;
  // The kernel for `pixels` output pixels (1..tile_pixels) of a tile.
  TileFunction kernel(const WeightTile& tile, int pixels) const {
    const auto index = static_cast<std::size_t>(pixels - 1);
    return tile.channels < kernels_->channels ? kernels_->narrow[index] : kernels_->full[index];
  }

 private:
  void pack(const WeightSource& source, const std::vector<float>& factor, std::vector<double>& sums);

  const TileKernels* kernels_ = nullptr;
  NumberFormat format_;
  int outputs_ = 0, taps_ = 0, depth_ = 0, tiles_ = 0;
  WeightMemory weights_;
  std::vector<float> scale_, bias_;  // one an output channel, padded; scale_ in int8 only
};

}  // namespace penumbra::nn
