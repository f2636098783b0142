#include "nn/layers/spatial_attention.h"

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/layers/activations.h"

namespace penumbra::nn {

namespace {

// [max_c F ; mean_c F] as an image of 4-channel pixels, so that the 7 x 7 convolution reads 4 channels,
// not 16.
FeatureMap pool_channels(const FeatureMap& map, int border, Arena& arena) {
  FeatureMap pooled(arena, map.batch(), 2, map.height(), map.width(), border, kImageBlock);
  parallel_for({map.images(), map.height()}, grain_of(map.blocks() * map.row_stride()), [&](int n, int y) {
    for (int x = 0; x < map.width(); ++x) {
      float top = map.pixel(n, 0, y, x)[0], sum = 0.0F;
      for (int b = 0; b < map.blocks(); ++b) {
        const float* f = map.pixel(n, b, y, x);
        const int lanes = std::min(kBlock, map.channels() - b * kBlock);
        for (int c = 0; c < lanes; ++c) {
          top = std::max(top, f[c]);
          sum += f[c];
        }
      }
      float* out = pooled.pixel(n, 0, y, x);
      out[0] = top;
      out[1] = sum / static_cast<float>(map.channels());
      out[2] = out[3] = 0.0F;
    }
  });
  return pooled;
}

}  // namespace

SpatialAttention::SpatialAttention(const Tensor& weight) {
  if (weight.shape.size() != 4 || weight.extent(0) != 1 || weight.extent(1) != 2 ||
      weight.extent(2) % 2 != 1 || weight.extent(2) != weight.extent(3)) {
    throw InputError("spatial attention", "a weight [1, 2, K, K] with odd K", to_string(weight.shape));
  }
  padding_ = static_cast<int>(weight.extent(2)) / 2;
  Conv2dOptions options;
  options.padding = padding_;
  conv_ = Conv2d(weight, {}, options, kImageBlock);
}

void SpatialAttention::apply(FeatureMap& map, Arena& arena) const {
  const FeatureMap logits = conv_(pool_channels(map, padding_, arena), arena);
  parallel_for({map.images(), map.height()}, grain_of(map.blocks() * map.row_stride()), [&](int n, int y) {
    for (int x = 0; x < map.width(); ++x) {
      const float gate = sigmoid(logits.pixel(n, 0, y, x)[0]);
      for (int b = 0; b < map.blocks(); ++b) {
        float* f = map.pixel(n, b, y, x);
        for (int c = 0; c < kBlock; ++c) f[c] *= gate;
      }
    }
  });
}

}  // namespace penumbra::nn
