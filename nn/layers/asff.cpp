#include "nn/layers/asff.h"

#include <omp.h>

#include <algorithm>
#include <utility>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/layers/activations.h"

namespace penumbra::nn {

namespace {

// w . f over the channels of a pixel; the sums of the 16 lanes are added last.
float dot(const float* w, const float* f, std::ptrdiff_t block_stride, int blocks) {
  float sum[kBlock] = {};
  for (int b = 0; b < blocks; ++b, w += kBlock, f += block_stride) {
    for (int c = 0; c < kBlock; ++c) sum[c] += w[c] * f[c];
  }
  float total = 0.0F;
  for (const float part : sum) total += part;
  return total;
}

}  // namespace

Asff::Asff(std::span<const Tensor> weights, std::vector<float> bias)
    : level_count_(weights.size()), bias_(std::move(bias)) {
  if (weights.empty() || (!bias_.empty() && bias_.size() != weights.size())) {
    throw InputError("asff", "one weight and one bias a level",
                     fmt::format("{} and {}", weights.size(), bias_.size()));
  }
  bias_.resize(level_count_, 0.0F);
  for (const Tensor& weight : weights) {
    if (weight.shape.size() != 4 || weight.shape != Shape{1, weights.front().extent(1), 1, 1}) {
      throw InputError("asff", "weights [1, C, 1, 1]", to_string(weight.shape));
    }
    channels_ = static_cast<int>(weight.extent(1));
    const std::size_t start = weights_.size();
    weights_.insert(weights_.end(), weight.values.begin(), weight.values.end());
    weights_.resize(start + static_cast<std::size_t>(ceil_div(channels_, kBlock)) * kBlock, 0.0F);
  }
}

FeatureMap Asff::operator()(std::span<const FeatureMap* const> levels, Arena& arena,
                            int output_border) const {
  if (levels.size() != level_count_) {
    throw InputError("asff", fmt::format("{} levels", level_count_), fmt::format("{}", levels.size()));
  }
  const FeatureMap& first = *levels.front();
  for (const FeatureMap* map : levels) {
    if (map->images() != first.images() || map->channels() != channels_ || map->height() != first.height() ||
        map->width() != first.width() || map->block() != kBlock) {
      throw InputError(
          "asff",
          fmt::format("levels of shape [{}, {}, {}, {}]", first.images(), channels_, first.height(),
                      first.width()),
          fmt::format("[{}, {}, {}, {}]", map->images(), map->channels(), map->height(), map->width()));
    }
  }
  FeatureMap output(arena, first.batch(), channels_, first.height(), first.width(), output_border);
  const std::size_t padded = weights_.size() / level_count_;
  const ArenaBuffer scratch = arena.allocate(static_cast<std::size_t>(omp_get_max_threads()) * level_count_);
#pragma omp parallel
  {
    const std::span<float> shares(
        scratch.data() + static_cast<std::size_t>(omp_get_thread_num()) * level_count_, level_count_);
#pragma omp for collapse(2)
    for (int n = 0; n < output.images(); ++n) {
      for (int y = 0; y < output.height(); ++y) {
        for (int x = 0; x < output.width(); ++x) {
          for (std::size_t k = 0; k < level_count_; ++k) {
            const FeatureMap& map = *levels[k];
            shares[k] = bias_[k] + dot(weights_.data() + k * padded, map.pixel(n, 0, y, x),
                                       map.block_stride(), map.blocks());
          }
          softmax(shares);
          for (int b = 0; b < output.blocks(); ++b) {
            float sum[kBlock] = {};
            for (std::size_t k = 0; k < level_count_; ++k) {
              const float* f = levels[k]->pixel(n, b, y, x);
              for (int c = 0; c < kBlock; ++c) sum[c] += shares[k] * f[c];
            }
            std::copy_n(sum, kBlock, output.pixel(n, b, y, x));
          }
        }
      }
    }
  }
  return output;
}

}  // namespace penumbra::nn
