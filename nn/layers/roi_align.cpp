#include "nn/layers/roi_align.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/kernel_table.h"
#include "nn/simd/tile_unit.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

AxisSample sample_axis(float position, int extent) {
  if (!(position >= -1.0F && position <= static_cast<float>(extent))) return {};  // also NaN
  position = std::max(position, 0.0F);
  const int low = static_cast<int>(position);
  if (low >= extent - 1) return {extent - 1, extent - 1, 1.0F, 0.0F};
  const float fraction = position - static_cast<float>(low);
  return {low, low + 1, 1.0F - fraction, fraction};
}

// The samples of all bins along one axis of a region, bin by bin.
struct Axis {
  int sampling = 0;     // G
  AxisSample* samples;  // size * sampling of them
};

// `low` and `high` are the region's ends in pixels of the map.
void sample_bins(float low, float high, const RoiAlignOptions& options, int map_extent, Axis& axis) {
  const float shift = options.aligned ? 0.5F : 0.0F, start = low - shift;
  const float extent = options.aligned ? high - low : std::max(high - low, 1.0F);
  const float bin = extent / static_cast<float>(options.size);
  axis.sampling = options.sampling;
  if (options.sampling == 0) {
    // The comparison is false for NaN, so that the conversion has a number to work on.
    const float wanted = std::ceil(bin);
    axis.sampling = wanted > 0.0F ? static_cast<int>(std::min(wanted, float{kMaxAdaptiveSampling})) : 0;
  }
  AxisSample* next = axis.samples;
  for (int i = 0; i < options.size; ++i) {
    for (int u = 0; u < axis.sampling; ++u) {
      const float position = start + static_cast<float>(i) * bin +
                             (static_cast<float>(u) + 0.5F) * bin / static_cast<float>(axis.sampling);
      *next++ = sample_axis(position, map_extent);
    }
  }
}

// The same where the map or the output is narrow.
void align_narrow_region(const FeatureMap& map, const Axis& rows, const Axis& columns, int size, int region,
                         FeatureMap& output) {
  const std::ptrdiff_t map_bytes = element_size(map.numbers().precision);
  const std::ptrdiff_t output_bytes = element_size(output.numbers().precision);
  RoiAlignLinesArguments a;
  a.map = map.line(0, 0, 0, 0);
  a.map_layout = {kLineBytes, map.block_stride() * map_bytes, map.numbers()};
  a.map_row_stride = map.row_stride() * map_bytes;
  a.rows = rows.samples;
  a.columns = columns.samples;
  a.row_sampling = rows.sampling;
  a.column_sampling = columns.sampling;
  a.size = size;
  // Also the channels beyond the last that only one of them stores.
  a.channels = std::min(map.blocks() * map.block(), output.blocks() * output.block());
  a.output = output.line(region, 0, 0, 0);
  a.output_layout = {kLineBytes, output.block_stride() * output_bytes, output.numbers()};
  a.output_row_stride = output.row_stride() * output_bytes;
  line_kernels()->roi_align_lines(a);
}

void align_region(const FeatureMap& map, const Axis& rows, const Axis& columns, int size, int region,
                  FeatureMap& output) {
  RoiAlignArguments a;
  a.map = map.pixel(0, 0, 0, 0);
  a.map_row_stride = map.row_stride();
  a.map_block_stride = map.block_stride();
  a.blocks = map.blocks();
  a.rows = rows.samples;
  a.columns = columns.samples;
  a.row_sampling = rows.sampling;
  a.column_sampling = columns.sampling;
  a.size = size;
  a.output = output.pixel(region, 0, 0, 0);
  a.output_row_stride = output.row_stride();
  a.output_block_stride = output.block_stride();
  kernels().roi_align(a);
}

// A region on its way through the threads.
struct Reading {
  std::size_t region = 0;
  PyramidLevel level;  // that it is read from
  float top = 0.0F;    // pixels of the image
};

// Regions level by level, from the top of the map down: the next one reads what is in the cache already.
// Those without a number for their top come last.
template <class LevelOf>
ArenaVector<Reading> reading_order(std::span<const Box> regions, int capacity, Arena& arena,
                                   LevelOf level_of) {
  ArenaVector<Reading> order(arena, static_cast<std::size_t>(capacity));
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const float top = regions[r].y1;
    order.push_back(
        {r, level_of(regions[r]), std::isnan(top) ? std::numeric_limits<float>::infinity() : top});
  }
  std::sort(order.begin(), order.end(), [](const Reading& a, const Reading& b) {
    return std::tuple(a.level.scale, a.top, a.region) < std::tuple(b.level.scale, b.top, b.region);
  });
  return order;
}

// level_of(box) is the level that a region is read from.
template <class LevelOf>
FeatureMap align(int channels, std::span<const Box> regions, RoiAlignOptions options, Arena& arena,
                 int output_border, int capacity, const Numbers& numbers, LevelOf level_of) {
  if (options.size < 1 || options.sampling < 0) {
    throw InputError("roi_align", "size >= 1 and sampling >= 0",
                     fmt::format("{} and {}", options.size, options.sampling));
  }
  const int count = static_cast<int>(regions.size());
  FeatureMap output(arena, {count, std::max(count, capacity)}, channels, options.size, options.size,
                    output_border, numbers);
  const int most_sampling = options.sampling == 0 ? kMaxAdaptiveSampling : options.sampling;
  const auto axis_samples = static_cast<std::size_t>(options.size) * static_cast<std::size_t>(most_sampling);
  const ArenaVector<Reading> order = reading_order(regions, output.batch().capacity, arena, level_of);
  ArenaVector<AxisSample> scratch(arena, 2 * axis_samples * static_cast<std::size_t>(thread_count()));
  parallel_for(order.size(), 4, [&](std::size_t k, int slot) {
    AxisSample* own = scratch.data() + 2 * axis_samples * static_cast<std::size_t>(slot);
    Axis rows{0, own}, columns{0, own + axis_samples};
    const auto& [r, level, top] = order[k];
    const Box& box = regions[r];
    sample_bins(box.y1 * level.scale, box.y2 * level.scale, options, level.map->height(), rows);
    sample_bins(box.x1 * level.scale, box.x2 * level.scale, options, level.map->width(), columns);
    const bool narrow =
        level.map->numbers().precision != Precision::f32 || numbers.precision != Precision::f32;
    const auto align = narrow ? align_narrow_region : align_region;
    align(*level.map, rows, columns, options.size, static_cast<int>(r), output);
  });
  return output;
}

}  // namespace

int roi_level(const Box& box, int levels) {
  constexpr float kCanonicalSize = 224.0F, kCanonicalLevel = 4.0F, kFinest = 2.0F;
  const float level = std::floor(kCanonicalLevel + std::log2(std::sqrt(box.area()) / kCanonicalSize) + 1e-6F);
  // An empty box gives log2(0) = -inf, which the clamp sends to the finest level.
  return static_cast<int>(std::clamp(level, kFinest, kFinest + static_cast<float>(levels - 1)) - kFinest);
}

FeatureMap roi_align(const FeatureMap& map, float scale, std::span<const Box> regions,
                     RoiAlignOptions options, Arena& arena, int output_border, int capacity) {
  return align(map.channels(), regions, options, arena, output_border, capacity, {}, [&](const Box&) {
    return PyramidLevel{&map, scale};
  });
}

FeatureMap multi_scale_roi_align(std::span<const PyramidLevel> levels, std::span<const Box> regions,
                                 RoiAlignOptions options, Arena& arena, int output_border, int capacity,
                                 const Numbers& output_numbers) {
  if (levels.empty()) throw InputError("roi_align", "at least one level", "none");
  return align(levels.front().map->channels(), regions, options, arena, output_border, capacity,
               output_numbers, [&](const Box& box) {
                 return levels[static_cast<std::size_t>(roi_level(box, static_cast<int>(levels.size())))];
               });
}

}  // namespace penumbra::nn
