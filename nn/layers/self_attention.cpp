#include "nn/layers/self_attention.h"

#include <omp.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/simd/exponential.h"

namespace penumbra::nn {

namespace {

// scores[i] = f[:, i] . query for all pixels i; returns the largest. The maps have no border, so their pixels
// are one row.
float score_pixels(const FeatureMap& f, int n, const float* query, std::ptrdiff_t query_block_stride,
                   std::ptrdiff_t pixels, float* scores) {
  float top = 0.0F;
  for (std::ptrdiff_t i = 0; i < pixels; ++i) {
    float sum[kBlock] = {};
    for (int b = 0; b < f.blocks(); ++b) {
      const float* key = f.pixel(n, b, 0, 0) + i * kBlock;
      const float* q = query + b * query_block_stride;
      for (int c = 0; c < kBlock; ++c) sum[c] += key[c] * q[c];
    }
    float total = 0.0F;
    for (const float part : sum) total += part;
    scores[i] = total;
    top = i == 0 ? total : std::max(top, total);
  }
  return top;
}

// out[c] += factor sum_i scores[i] h[c, i]
void add_weighted(const FeatureMap& h, int n, const float* scores, std::ptrdiff_t pixels, float factor,
                  float* out, std::ptrdiff_t out_block_stride) {
  constexpr std::ptrdiff_t kRun = 64;  // sums of runs keep the rounding error of a large map small
  for (int b = 0; b < h.blocks(); ++b) {
    const float* value = h.pixel(n, b, 0, 0);
    float sum[kBlock] = {};
    for (std::ptrdiff_t first = 0; first < pixels; first += kRun) {
      float run_sum[kBlock] = {};
      for (std::ptrdiff_t i = first; i < std::min(first + kRun, pixels); ++i) {
        for (int c = 0; c < kBlock; ++c) run_sum[c] += scores[i] * value[i * kBlock + c];
      }
      for (int c = 0; c < kBlock; ++c) sum[c] += run_sum[c];
    }
    for (int c = 0; c < kBlock; ++c) out[b * out_block_stride + c] += factor * sum[c];
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
  const ArenaBuffer scratch =
      arena.allocate(static_cast<std::size_t>(omp_get_max_threads()) * static_cast<std::size_t>(pixels));
#pragma omp parallel for collapse(3)
  for (int n = 0; n < map.images(); ++n) {
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        float* scores = scratch.data() + omp_get_thread_num() * pixels;
        const float top = score_pixels(f, n, g.pixel(n, 0, y, x), g.block_stride(), pixels, scores);
        for (std::ptrdiff_t i = 0; i < pixels; ++i) scores[i] = exponential(scores[i] - top);
        double sum = 0.0;
        for (std::ptrdiff_t i = 0; i < pixels; ++i) sum += scores[i];
        add_weighted(h, n, scores, pixels, gamma_ / static_cast<float>(sum), map.pixel(n, 0, y, x),
                     map.block_stride());
      }
    }
  }
}

}  // namespace penumbra::nn
