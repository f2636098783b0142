#include "nn/layers/self_attention.h"

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

namespace {

// keys[d][i] = f[d, i]; what lies beyond the pixels of a row of keys is 0.
void transpose_keys(const FeatureMap& f, int n, std::ptrdiff_t pixels, std::ptrdiff_t stride, float* keys) {
  for (int d = 0; d < f.channels(); ++d) {
    const float* channel = f.pixel(n, d / kBlock, 0, 0) + d % kBlock;
    float* row = keys + d * stride;
    for (std::ptrdiff_t i = 0; i < pixels; ++i) row[i] = channel[i * kBlock];
    std::fill(row + pixels, row + stride, 0.0F);
  }
}

}  // namespace

SelfAttention::SelfAttention(const SelfAttentionWeights& weights) : gamma_(weights.gamma) {
  const Shape& shape = weights.f.shape;
  if (shape.size() != 4 || shape[2] != 1 || shape[3] != 1 || weights.g.shape != shape ||
      weights.h.shape != Shape{shape[1], shape[1], 1, 1}) {
    throw InputError(
        "self-attention", "weights twice [D, C, 1, 1] and [C, C, 1, 1]",
        to_string(shape) + ", " + to_string(weights.g.shape) + ", " + to_string(weights.h.shape));
  }
  f_ = Conv2d(weights.f, weights.f_bias, {});
  g_ = Conv2d(weights.g, weights.g_bias, {});
  h_ = Conv2d(weights.h, weights.h_bias, {});
}

void SelfAttention::apply(FeatureMap& map, Arena& arena) const {
  const FeatureMap f = f_(map, arena), g = g_(map, arena), h = h_(map, arena);
  const std::ptrdiff_t pixels = static_cast<std::ptrdiff_t>(map.height()) * map.width();
  const std::ptrdiff_t stride = (pixels + kBlock - 1) / kBlock * kBlock;
  const ArenaBuffer keys = arena.allocate(static_cast<std::size_t>(f.channels() * stride));
  const ArenaBuffer scratch =
      arena.allocate(static_cast<std::size_t>(thread_count()) * static_cast<std::size_t>(stride));
  for (int n = 0; n < map.images(); ++n) {
    transpose_keys(f, n, pixels, stride, keys.data());
    const std::int64_t values = pixels * (f.channels() + map.channels());
    parallel_for({map.height(), map.width()}, grain_of(values), [&](int y, int x, int slot) {
      AttendArguments a;
      a.keys = keys.data();
      a.key_stride = stride;
      a.depth = f.channels();
      a.query = g.pixel(n, 0, y, x);
      a.query_block_stride = g.block_stride();
      a.values = h.pixel(n, 0, 0, 0);
      a.value_block_stride = h.block_stride();
      a.blocks = h.blocks();
      a.pixels = pixels;
      a.factor = gamma_;
      a.scores = scratch.data() + slot * stride;
      a.output = map.pixel(n, 0, y, x);
      a.output_block_stride = map.block_stride();
      kernels().attend(a);
    });
  }
}

}  // namespace penumbra::nn
