// Weights in the order in which the register-tile kernel reads them: [tile][tap][depth / g][V][g], where V is
// the tile's output channels (32, 16 or 8 by instruction set; the last tile may be a narrow one of 16) and g
// the channels that one instruction adds up (1 of f32, 2 of bf16, 4 of int8). Output channels are padded with
// zeros to whole blocks of 16. See nn/simd/kernel_table.h.
//
// In int8 every output channel o has a scale of its own, s_o = max |w_o| / 127, and inputs are
// x = s (q - zero). With whole numbers q and q_w the tile computes s s_o sum q q_w; what the zero adds to
// that, -s s_o zero sum q_w, is part of the bias.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "nn/layers/number_format.h"
#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

// One tile's part of the packed weights and where its channels lie in a channel-blocked output.
struct WeightTile {
  const std::byte* weights;  // [tap][depth / g][V][g]
  const float* scale;        // [V] in int8, else null
  const float* bias;         // [V]
  int block;                 // block of the first output channel
  int lane;                  // its place in the block
  int channels;              // V, or 16 in a narrow tile
};

class PackedWeights {
 public:
  PackedWeights() = default;
  // `weight(o, t, c)` gives the weight of output channel o, tap t and channel c of the tap; `bias` has one
  // value an output channel or is empty for none. `depth` must be a multiple of 4 g.
  PackedWeights(int outputs, int taps, int depth, const std::function<float(int, int, int)>& weight,
                const std::vector<float>& bias, const NumberFormat& format = {});

  int outputs() const { return outputs_; }
  int taps() const { return taps_; }
  int depth() const { return depth_; }
  int tiles() const { return tiles_; }
  int tile_pixels() const { return kernels_->pixels; }
  int tile_channels() const { return kernels_->channels; }
  const NumberFormat& format() const { return format_; }

  WeightTile tile(int t) const;
  // The arguments that are the same for all pixels, for `tap_count` taps from `first_tap` on.
  void prepare(const WeightTile& tile, int first_tap, int tap_count, TileArguments& arguments) const;
  // The kernel for `pixels` output pixels (1..tile_pixels) of a tile.
  TileFunction kernel(const WeightTile& tile, int pixels) const {
    const auto index = static_cast<std::size_t>(pixels - 1);
    return tile.channels < kernels_->channels ? kernels_->narrow[index] : kernels_->full[index];
  }

 private:
  struct Free {
    void operator()(std::byte* data) const;
  };
  const TileKernels* kernels_ = nullptr;
  NumberFormat format_;
  int outputs_ = 0, taps_ = 0, depth_ = 0, tiles_ = 0;
  std::unique_ptr<std::byte, Free> weights_;
  std::vector<float> scale_, bias_;  // one an output channel, padded; scale_ in int8 only
};

}  // namespace penumbra::nn
