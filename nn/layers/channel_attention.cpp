#include "nn/layers/channel_attention.h"

#include <algorithm>
#include <span>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/layers/activations.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

// sum += W_2 relu(W_1 v)
void add_mlp(const Tensor& reduce, const Tensor& expand, std::span<const float> v, std::span<float> hidden,
             std::span<float> sum) {
  const std::size_t hidden_size = hidden.size();
  for (std::size_t i = 0; i < hidden_size; ++i) {
    hidden[i] = 0.0F;
    for (std::size_t c = 0; c < v.size(); ++c) hidden[i] += reduce.values[i * v.size() + c] * v[c];
    hidden[i] = std::max(hidden[i], 0.0F);
  }
  for (std::size_t c = 0; c < v.size(); ++c) {
    for (std::size_t i = 0; i < hidden_size; ++i) sum[c] += expand.values[c * hidden_size + i] * hidden[i];
  }
}

}  // namespace

ChannelAttention::ChannelAttention(Tensor reduce, Tensor expand)
    : reduce_(std::move(reduce)), expand_(std::move(expand)) {
  if (reduce_.shape.size() != 2 || expand_.shape != Shape{reduce_.extent(1), reduce_.extent(0)}) {
    throw InputError("channel attention", "weights [C/r, C] and [C, C/r]",
                     to_string(reduce_.shape) + " and " + to_string(expand_.shape));
  }
}

void ChannelAttention::apply(FeatureMap& map, Arena& arena) const {
  const auto channels = static_cast<std::size_t>(map.channels());
  if (static_cast<std::int64_t>(channels) != reduce_.extent(1)) {
    throw InputError("channel attention", fmt::format("{} channels", reduce_.extent(1)),
                     fmt::format("{}", channels));
  }
  const auto padded = static_cast<std::size_t>(map.blocks()) * kBlock;
  ArenaVector<float> top(arena, channels), mean(arena, channels), gate(arena, padded);
  ArenaVector<float> hidden(arena, static_cast<std::size_t>(reduce_.extent(0)));
  for (ArenaVector<float>* values : {&top, &mean, &gate, &hidden}) values->resize(values->capacity());
  for (int n = 0; n < map.images(); ++n) {
    parallel_for(map.blocks(), grain_of(map.block_stride()), [&](int b) {
      float block_top[kBlock], block_sum[kBlock] = {};
      std::copy_n(map.pixel(n, b, 0, 0), kBlock, block_top);
      for (int y = 0; y < map.height(); ++y) {
        float row_sum[kBlock] = {};  // sums by rows keep the rounding error of a large map small
        for (int x = 0; x < map.width(); ++x) {
          const float* f = map.pixel(n, b, y, x);
          for (int c = 0; c < kBlock; ++c) {
            block_top[c] = std::max(block_top[c], f[c]);
            row_sum[c] += f[c];
          }
        }
        for (int c = 0; c < kBlock; ++c) block_sum[c] += row_sum[c];
      }
      const auto first = static_cast<std::size_t>(b) * kBlock;
      for (std::size_t c = first; c < std::min(first + kBlock, channels); ++c) {
        top[c] = block_top[c - first];
        mean[c] = block_sum[c - first] / static_cast<float>(map.height() * map.width());
      }
    });
    const std::span<float> gates = gate.span().first(channels);
    std::fill(gate.begin(), gate.end(), 0.0F);
    add_mlp(reduce_, expand_, top.span(), hidden.span(), gates);
    add_mlp(reduce_, expand_, mean.span(), hidden.span(), gates);
    for (float& g : gates) g = sigmoid(g);
    parallel_for(map.blocks(), grain_of(map.block_stride()), [&](int b) {
      const float* g = gate.data() + static_cast<std::ptrdiff_t>(b) * kBlock;
      for (int y = 0; y < map.height(); ++y) {
        for (int x = 0; x < map.width(); ++x) {
          float* f = map.pixel(n, b, y, x);
          for (int c = 0; c < kBlock; ++c) f[c] *= g[c];
        }
      }
    });
  }
}

}  // namespace penumbra::nn
