#include "nn/layers/asff.h"

#include <omp.h>

#include <algorithm>
#include <utility>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/layers/activations.h"

namespace penumbra::nn {

namespace {

// w . f over the channels of a pixel; the sums of the 16 lanes are added last, in pairs.
float dot(const float* w, const float* f, std::ptrdiff_t block_stride, int blocks) {
  float sum[kBlock] = {};
  for (int b = 0; b < blocks; ++b, w += kBlock, f += block_stride) {
    for (int c = 0; c < kBlock; ++c) sum[c] += w[c] * f[c];
  }
  for (int half = kBlock / 2; half > 0; half /= 2) {
    for (int c = 0; c < half; ++c) sum[c] += sum[c + half];
  }
  return sum[0];
}

// Row y of block b: sum_k alpha_k F_k; `shares` holds those of the row's pixels, all levels of a pixel side
// by side.
void mix_row(std::span<const FeatureMap* const> levels, const float* shares, int n, int b, int y,
             FeatureMap& output) {
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int factor = output.width() / levels[k]->width();
    const float* f = levels[k]->pixel(n, b, y / factor, 0);
    const float* share = shares + k;
    float* out = output.pixel(n, b, y, 0);
    for (int x = 0; x < levels[k]->width(); ++x, f += kBlock) {
      for (int r = 0; r < factor; ++r, share += levels.size(), out += kBlock) {
        for (int c = 0; c < kBlock; ++c) out[c] = k == 0 ? *share * f[c] : out[c] + *share * f[c];
      }
    }
  }
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

void Asff::lambda_row(const FeatureMap& level, std::size_t k, int n, int y, int width, float* lambda) const {
  const int factor = width / level.width();
  const float* f = level.pixel(n, 0, y / factor, 0);
  const float* w = weights_.data() + k * (weights_.size() / level_count_);
  for (int x = 0; x < level.width(); ++x, f += kBlock) {
    const float value = bias_[k] + dot(w, f, level.block_stride(), level.blocks());
    for (int r = 0; r < factor; ++r, lambda += level_count_) *lambda = value;
  }
}

FeatureMap Asff::operator()(std::span<const FeatureMap* const> levels, Arena& arena,
                            int output_border) const {
  if (levels.size() != level_count_) {
    throw InputError("asff", fmt::format("{} levels", level_count_), fmt::format("{}", levels.size()));
  }
  int height = 0, width = 0;
  for (const FeatureMap* map : levels) {
    height = std::max(height, map->height());
    width = std::max(width, map->width());
  }
  for (const FeatureMap* map : levels) {
    if (map->images() != levels.front()->images() || map->channels() != channels_ || map->block() != kBlock ||
        map->height() * (width / map->width()) != height || width % map->width() != 0) {
      throw InputError(
          "asff",
          fmt::format("levels of shape [{}, {}, {}, {}] or coarser by a whole factor",
                      levels.front()->images(), channels_, height, width),
          fmt::format("[{}, {}, {}, {}]", map->images(), map->channels(), map->height(), map->width()));
    }
  }
  FeatureMap output(arena, levels.front()->batch(), channels_, height, width, output_border);
  const std::size_t row_values = static_cast<std::size_t>(width) * level_count_;
  const ArenaBuffer scratch =  // a row's shares, of each thread
      arena.allocate(static_cast<std::size_t>(omp_get_max_threads()) * row_values);
#pragma omp parallel
  {
    float* shares = scratch.data() + static_cast<std::size_t>(omp_get_thread_num()) * row_values;
#pragma omp for collapse(2)
    for (int n = 0; n < output.images(); ++n) {
      for (int y = 0; y < height; ++y) {
        for (std::size_t k = 0; k < level_count_; ++k) lambda_row(*levels[k], k, n, y, width, shares + k);
        for (std::size_t x = 0; x < row_values; x += level_count_) {
          softmax(std::span(shares + x, level_count_));
        }
        for (int b = 0; b < output.blocks(); ++b) mix_row(levels, shares, n, b, y, output);
      }
    }
  }
  return output;
}

}  // namespace penumbra::nn
