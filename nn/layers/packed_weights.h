// Weights in the order in which the register-tile kernel reads them: [tile][tap][depth][V], where V is the
// tile's output channels (32, 16 or 8 by instruction set; the last tile may be a narrow one of 16). Output
// channels are padded with zeros to whole blocks of 16. See nn/simd/kernel_table.h.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "nn/simd/kernel_table.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// One tile's part of the packed weights and where its channels lie in a channel-blocked output.
struct WeightTile {
  const float* weights;  // [tap][depth][V]
  const float* bias;     // [V]
  int block;             // block of the first output channel
  int lane;              // its place in the block
  bool narrow;           // 16 channels where the full tile has 32
};

class PackedWeights {
 public:
  PackedWeights() = default;
  // `weight(o, t, c)` gives the weight of output channel o, tap t and channel c of the tap; `bias` has one
  // value an output channel or is empty for none. `depth` must be a multiple of 4.
  PackedWeights(int outputs, int taps, int depth, const std::function<float(int, int, int)>& weight,
                const std::vector<float>& bias);

  int outputs() const { return outputs_; }
  int taps() const { return taps_; }
  int depth() const { return depth_; }
  int tiles() const { return tiles_; }
  WeightTile tile(int t) const;
  // The kernel for `pixels` output pixels (1..tile_pixels) of a tile.
  TileFunction kernel(const WeightTile& tile, int pixels) const {
    const auto index = static_cast<std::size_t>(pixels - 1);
    return tile.narrow ? kernels_->narrow_tile[index] : kernels_->tile[index];
  }
  int tile_pixels() const { return kernels_->tile_pixels; }

 private:
  struct Free {
    void operator()(float* data) const;
  };
  const KernelTable* kernels_ = nullptr;
  int outputs_ = 0, taps_ = 0, depth_ = 0, tiles_ = 0;
  std::unique_ptr<float, Free> weights_;
  std::vector<float> bias_;
};

}  // namespace penumbra::nn
