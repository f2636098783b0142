#include "nn/layers/packed_weights.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace penumbra::nn {

void PackedWeights::Free::operator()(float* data) const { std::free(data); }

PackedWeights::PackedWeights(int outputs, int taps, int depth,
                             const std::function<float(int, int, int)>& weight,
                             const std::vector<float>& bias)
    : kernels_(&kernels()), outputs_(outputs), taps_(taps), depth_(depth) {
  const int padded = (outputs + kBlock - 1) / kBlock * kBlock;
  const int width = kernels_->tile_channels;
  tiles_ = (padded + width - 1) / width;
  const std::size_t row = static_cast<std::size_t>(taps) * depth;  // weights of one output channel
  const std::size_t bytes = static_cast<std::size_t>(padded) * row * sizeof(float);  // a multiple of 64
  weights_.reset(static_cast<float*>(std::aligned_alloc(64, std::max<std::size_t>(bytes, 64))));
  if (weights_ == nullptr) throw std::bad_alloc();
  bias_.assign(static_cast<std::size_t>(padded), 0.0F);
  std::copy(bias.begin(), bias.end(), bias_.begin());

  float* out = weights_.get();
  for (int first = 0; first < padded; first += width) {
    const int channels = std::min(width, padded - first);
    for (int t = 0; t < taps; ++t) {
      for (int c = 0; c < depth; ++c) {
        for (int o = first; o < first + channels; ++o) *out++ = o < outputs ? weight(o, t, c) : 0.0F;
      }
    }
  }
}

WeightTile PackedWeights::tile(int t) const {
  const int first = t * kernels_->tile_channels;
  const std::size_t row = static_cast<std::size_t>(taps_) * depth_;
  const bool narrow = static_cast<int>(bias_.size()) - first < kernels_->tile_channels;
  return {weights_.get() + static_cast<std::size_t>(first) * row, bias_.data() + first, first / kBlock,
          first % kBlock, narrow};
}

}  // namespace penumbra::nn
