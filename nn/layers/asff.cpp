#include "nn/layers/asff.h"

#include <algorithm>
#include <utility>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/kernel_table.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

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
  // Of each thread: the levels as the kernel takes them, and a row's shares.
  const auto threads = static_cast<std::size_t>(thread_count());
  const std::size_t row_values = static_cast<std::size_t>(width) * level_count_;
  const ArenaBuffer shares = arena.allocate(threads * row_values);
  ArenaVector<MixedLevel> rows(arena, threads * level_count_);
  rows.resize(rows.capacity());
  const auto values = static_cast<std::int64_t>(level_count_) * output.blocks() * output.row_stride();
  parallel_for({output.images(), height}, grain_of(values), [&](int n, int y, int slot) {
    const auto thread = static_cast<std::size_t>(slot);
    MixedLevel* row = rows.data() + thread * level_count_;
    for (std::size_t k = 0; k < level_count_; ++k) {
      const int factor = width / levels[k]->width();
      row[k] = {levels[k]->pixel(n, 0, y / factor, 0), levels[k]->block_stride(), factor,
                weights_.data() + k * (weights_.size() / level_count_), bias_[k]};
    }
    kernels().mix_row({row, static_cast<int>(level_count_), width, output.blocks(),
                       shares.data() + thread * row_values, output.pixel(n, 0, y, 0), output.block_stride()});
  });
  return output;
}

}  // namespace penumbra::nn
