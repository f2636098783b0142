#include "nn/layers/roi_align.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace penumbra::nn {

namespace {

// A bilinear sample along one axis: two neighbouring pixels and their weights; both weights are 0 outside the
// map.
struct AxisSample {
  int low = 0, high = 0;
  float low_weight = 0.0F, high_weight = 0.0F;
};

AxisSample sample_axis(float position, int extent) {
  if (!(position >= -1.0F && position <= static_cast<float>(extent))) return {};  // also NaN
  position = std::max(position, 0.0F);
  const int low = static_cast<int>(position);
  if (low >= extent - 1) return {extent - 1, extent - 1, 1.0F, 0.0F};
  const float fraction = position - static_cast<float>(low);
  return {low, low + 1, 1.0F - fraction, fraction};
}

// The samples of all bins along one axis, bin by bin.
void sample_bins(float start, float extent, RoiAlignOptions options, int map_extent, AxisSample* samples) {
  const float bin = extent / static_cast<float>(options.size);
  for (int i = 0; i < options.size; ++i) {
    for (int u = 0; u < options.sampling; ++u) {
      const float position = start + static_cast<float>(i) * bin +
                             (static_cast<float>(u) + 0.5F) * bin / static_cast<float>(options.sampling);
      *samples++ = sample_axis(position, map_extent);
    }
  }
}

}  // namespace

int roi_level(const Box& box, int levels) {
  constexpr float kCanonicalSize = 224.0F, kCanonicalLevel = 4.0F, kFinest = 2.0F;
  const float level = std::floor(kCanonicalLevel + std::log2(std::sqrt(box.area()) / kCanonicalSize) + 1e-6F);
  // An empty box gives log2(0) = -inf, which the clamp sends to the finest level.
  return static_cast<int>(std::clamp(level, kFinest, kFinest + static_cast<float>(levels - 1)) - kFinest);
}

FeatureMap multi_scale_roi_align(std::span<const PyramidLevel> levels, std::span<const Box> regions,
                                 RoiAlignOptions options, Arena& arena, int output_border) {
  const int size = options.size, sampling = options.sampling;
  const int channels = levels.front().map->channels();
  FeatureMap output(arena, static_cast<int>(regions.size()), channels, size, size, output_border);
  const float share = 1.0F / static_cast<float>(sampling * sampling);

#pragma omp parallel
  {
    std::vector<AxisSample> rows(static_cast<std::size_t>(size * sampling)), columns(rows.size());
#pragma omp for schedule(dynamic, 4)
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const PyramidLevel& level =
          levels[static_cast<std::size_t>(roi_level(regions[r], static_cast<int>(levels.size())))];
      const FeatureMap& map = *level.map;
      const float x1 = regions[r].x1 * level.scale, y1 = regions[r].y1 * level.scale;
      const float width = std::max(regions[r].x2 * level.scale - x1, 1.0F);
      const float height = std::max(regions[r].y2 * level.scale - y1, 1.0F);
      sample_bins(y1, height, options, map.height(), rows.data());
      sample_bins(x1, width, options, map.width(), columns.data());

      for (int b = 0; b < map.blocks(); ++b) {
        for (int i = 0; i < size; ++i) {
          for (int j = 0; j < size; ++j) {
            float sum[kBlock] = {};
            for (int u = 0; u < sampling; ++u) {
              const AxisSample& row = rows[static_cast<std::size_t>(i * sampling + u)];
              for (int v = 0; v < sampling; ++v) {
                const AxisSample& column = columns[static_cast<std::size_t>(j * sampling + v)];
                const float* p00 = map.pixel(0, b, row.low, column.low);
                const float* p01 = map.pixel(0, b, row.low, column.high);
                const float* p10 = map.pixel(0, b, row.high, column.low);
                const float* p11 = map.pixel(0, b, row.high, column.high);
                const float w00 = row.low_weight * column.low_weight,
                            w01 = row.low_weight * column.high_weight;
                const float w10 = row.high_weight * column.low_weight,
                            w11 = row.high_weight * column.high_weight;
                for (int c = 0; c < kBlock; ++c) {
                  sum[c] += w00 * p00[c] + w01 * p01[c] + w10 * p10[c] + w11 * p11[c];
                }
              }
            }
            float* out = output.pixel(static_cast<int>(r), b, i, j);
            for (int c = 0; c < kBlock; ++c) out[c] = sum[c] * share;
          }
        }
      }
    }
  }
  return output;
}

}  // namespace penumbra::nn
