#include "nn/layers/activations.h"

#include "nn/base/parallel.h"
#include "nn/simd/exponential.h"
#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

void activate(float* values, std::ptrdiff_t count, Activation activation, float slope) {
  kernels().activate(values, count, activation, slope);
}

void activate(FeatureMap& map, Activation activation, float slope) {
  parallel_for({map.images(), map.blocks(), map.height()}, grain_of(map.row_stride()),
               [&](int n, int b, int y) {
                 activate(map.pixel(n, b, y, 0), static_cast<std::ptrdiff_t>(map.width()) * map.block(),
                          activation, slope);
               });
}

void softmax_channels(FeatureMap& map) {
  const int last_lanes = map.channels() - (map.blocks() - 1) * map.block();
  const auto lanes = [&](int b) { return b + 1 < map.blocks() ? map.block() : last_lanes; };
  const std::int64_t row_values = std::int64_t{map.blocks()} * map.row_stride();
  parallel_for({map.images(), map.height()}, grain_of(4 * row_values), [&](int n, int y) {
    for (int x = 0; x < map.width(); ++x) {
      float top = map.pixel(n, 0, y, x)[0], sum = 0.0F;
      for (int b = 0; b < map.blocks(); ++b) {
        const float* f = map.pixel(n, b, y, x);
        for (int c = 0; c < lanes(b); ++c) top = std::max(top, f[c]);
      }
      for (int b = 0; b < map.blocks(); ++b) {
        float* f = map.pixel(n, b, y, x);
        for (int c = 0; c < lanes(b); ++c) sum += f[c] = exponential(f[c] - top);
      }
      for (int b = 0; b < map.blocks(); ++b) {
        float* f = map.pixel(n, b, y, x);
        for (int c = 0; c < lanes(b); ++c) f[c] /= sum;
      }
    }
  });
}

}  // namespace penumbra::nn
