#include "nn/layers/tile_convolution.h"

#include <algorithm>
#include <array>

#include "nn/base/ceil_div.h"
#include "nn/base/parallel.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

// A task's input: a quarter of a 2 MB L2, which the weights of 32 outputs pass as well.
constexpr std::ptrdiff_t kTilePatchBytes = 512 * 1024;
constexpr int kTilePatchRows = 4;  // of the output at most, for kernels that share rows of the input
constexpr int kMostSegments = 32;  // of a task
constexpr int kTileTasksPerThread = 12;
// Over images: the weights of a panel are 32 KB for 32 outputs, its inputs 512 KB, a task's sums 512 KB.
constexpr int kTilePanelTaps = 16;
constexpr int kPanelTiles = 8;  // of 32 outputs

// Where a map's pixels lie as the segments see them: rows of columns, distances in bytes.
template <class Map>
struct TileGrid {
  Map* map;
  int row, column, step;        // of pixel (0, 0), and to the next
  std::ptrdiff_t column_bytes;  // from a column to the next

  auto* line(int n, int y, int x) const { return map->line(n, 0, row + y * step, column) + x * column_bytes; }
};

template <class Map>
TileGrid<Map> tile_grid(Map& map, int row, int column, int step, bool over_images) {
  const std::ptrdiff_t values = over_images ? map.image_stride() : std::ptrdiff_t{step} * map.block();
  return {&map, row, column, step, values * element_size(map.numbers().precision)};
}

template <class Map>
LineLayout line_layout(const TileGrid<Map>& grid) {
  const Numbers& numbers = grid.map->numbers();
  return {grid.column_bytes, grid.map->block_stride() * element_size(numbers.precision), numbers};
}

// Pointwise convolutions of stride 1 between maps without borders see one long row.
bool is_one_row(const TileConvolution& c) {
  const bool same = c.stride == 1 && c.padding == 0 && c.step == 1 &&
                    c.input->height() == c.output->height() && c.input->width() == c.output->width();
  return same && c.input->border() == 0 && c.output->border() == 0 &&
         (c.residual == nullptr || c.residual->border() == 0);
}

// What is the same in all calls.
TileUnitArguments common_arguments(const TileConvolution& c, bool over_images) {
  TileUnitArguments a;
  const auto in = tile_grid(*c.input, -c.padding, -c.padding, c.stride, over_images);
  a.precision = c.weights->format().precision;
  a.input_pixel_stride = in.column_bytes;
  a.taps = c.taps;
  a.tap_count = c.weights->taps();
  a.weight_tile_bytes = std::ptrdiff_t{c.weights->taps()} * kLineBytes * kTileBlockOutputs;
  a.output = line_layout(tile_grid(*c.output, c.row, c.column, c.step, over_images));
  if (c.residual != nullptr) a.residual = line_layout(tile_grid(*c.residual, 0, 0, 1, over_images));
  a.activation = c.activation;
  a.slope = c.slope;
  a.activate = kernels().activate;
  return a;
}

void set_outputs(const PackedWeights& weights, int first_tile, int end_tile, TileUnitArguments& a) {
  const WeightTile tile = weights.tile(first_tile);
  a.weights = tile.weights;
  a.scale = tile.scale;
  a.bias = tile.bias;
  a.first_output = first_tile * kTileBlockOutputs;
  a.outputs =
      std::min(end_tile * kTileBlockOutputs, ceil_div(weights.outputs(), kBlock) * kBlock) - a.first_output;
}

void convolve_images_on_tiles(const TileConvolution& c, Arena& arena) {
  const int images = c.output->images(), tiles = c.weights->tiles(), taps = c.weights->taps();
  const auto in = tile_grid(*c.input, -c.padding, -c.padding, c.stride, true);
  const auto out = tile_grid(*c.output, 0, 0, 1, true);
  const TileUnitArguments common = common_arguments(c, true);
  // Fewer outputs a task where there would be no task for every thread. The most images decide, so that the
  // memory is the same for any number of them.
  const int most_groups = ceil_div(c.output->batch().capacity, kMostSegments * kTileRows);
  const int group_tiles = std::clamp(tiles * most_groups / thread_count(), 1, std::min(kPanelTiles, tiles));
  const int groups = ceil_div(images, kMostSegments * kTileRows), tile_groups = ceil_div(tiles, group_tiles);
  const int most_segments = std::min(kMostSegments, ceil_div(c.output->batch().capacity, kTileRows));
  const std::size_t sum_floats = static_cast<std::size_t>(group_tiles) *
                                 static_cast<std::size_t>(ceil_div(most_segments, 2)) * kTileBlockSums;
  const ArenaBuffer sums =
      arena.allocate(taps > kTilePanelTaps ? sum_floats * static_cast<std::size_t>(thread_count()) : 0);

  parallel_for({groups, tile_groups}, 1, [&](int group, int tile_group, int slot) {
    const int first = images * group / groups, end = images * (group + 1) / groups;
    std::array<TileSegment, kMostSegments> segments;
    std::size_t count = 0;
    for (int x = first; x < end; x += kTileRows) {
      TileSegment& segment = segments[count++];
      segment.input = in.line(0, 0, x);
      segment.output = out.line(0, 0, x);
      if (c.residual != nullptr) segment.residual = c.residual->line(x, 0, 0, 0);
      segment.pixels = std::min(kTileRows, end - x);
    }
    TileUnitArguments a = common;
    a.segments = segments.data();
    a.segment_count = static_cast<int>(count);
    set_outputs(*c.weights, tile_group * group_tiles, std::min((tile_group + 1) * group_tiles, tiles), a);
    if (taps > kTilePanelTaps) {
      a.sums = sums.data() + static_cast<std::size_t>(slot) * sum_floats;
    }
    for (a.first_tap = 0; a.first_tap < taps; a.first_tap += kTilePanelTaps) {
      a.tap_count = std::min(kTilePanelTaps, taps - a.first_tap);
      a.continued = a.first_tap > 0;
      a.unfinished = a.first_tap + kTilePanelTaps < taps;
      tile_unit()->multiply(a);
    }
  });
}

}  // namespace

void convolve_on_tiles(const TileConvolution& c, Arena& arena) {
  FeatureMap& output = *c.output;
  int rows = ceil_div(output.height() - c.row, c.step), columns = ceil_div(output.width() - c.column, c.step);
  if (output.height() == 1 && output.width() == 1 && c.step == 1) {
    convolve_images_on_tiles(c, arena);
    return;
  }
  if (is_one_row(c)) {
    columns *= rows;
    rows = 1;
  }
  const int images = output.images();
  if (images == 0 || rows <= 0 || columns <= 0) return;
  const auto in = tile_grid(*c.input, -c.padding, -c.padding, c.stride, false);
  const auto out = tile_grid(output, c.row, c.column, c.step, false);
  const TileUnitArguments common = common_arguments(c, false);

  // A patch: as many segments as the cache allows, of a few rows.
  const int row_segments = ceil_div(columns, kTileRows);
  const std::ptrdiff_t pixel_bytes = c.input->blocks() * std::ptrdiff_t{kLineBytes} * c.stride * c.stride;
  const int budget = static_cast<int>(
      std::clamp<std::ptrdiff_t>(kTilePatchBytes / (pixel_bytes * kTileRows), 2, kMostSegments));
  int patch_rows = std::min({rows, kTilePatchRows, budget});
  const int patch_segments = std::clamp(budget / patch_rows, 1, row_segments);
  patch_rows = std::min(rows, budget / patch_segments);
  const int row_patches = ceil_div(rows, patch_rows), column_patches = ceil_div(row_segments, patch_segments);
  // Where patches are few, a task has some of the outputs only.
  const std::int64_t patches = std::int64_t{images} * row_patches * column_patches;
  const std::int64_t wanted = std::int64_t{kTileTasksPerThread} * thread_count();
  const int tiles = c.weights->tiles();
  const int parts = static_cast<int>(std::clamp<std::int64_t>((wanted + patches - 1) / patches, 1, tiles));

  using Segments = std::array<TileSegment, kMostSegments>;
  // Whole segments first, so that tiles of one shape come one after the other.
  const auto collect = [&](int n, int row_patch, int column_patch, Segments& segments) {
    std::size_t count = 0;
    const int end_row = std::min((row_patch + 1) * patch_rows, rows);
    const int first = column_patch * patch_segments, end = std::min(first + patch_segments, row_segments);
    for (const bool whole : {true, false}) {
      for (int y = row_patch * patch_rows; y < end_row; ++y) {
        for (int s = first; s < end; ++s) {
          const int x = s * kTileRows, pixels = std::min(kTileRows, columns - x);
          if ((pixels == kTileRows) != whole) continue;
          TileSegment& segment = segments[count++];
          segment.input = in.line(n, y, x);
          segment.output = out.line(n, y, x);
          if (c.residual != nullptr)
            segment.residual = c.residual->line(n, 0, y, 0) + x * common.residual.pixel_stride;
          segment.pixels = pixels;
        }
      }
    }
    return static_cast<int>(count);
  };
  const int extents[] = {images, row_patches, column_patches, parts};
  parallel_for(extents, 1, [&](int n, int row_patch, int column_patch, int part) {
    Segments segments;
    TileUnitArguments a = common;
    a.segment_count = collect(n, row_patch, column_patch, segments);
    a.segments = segments.data();
    set_outputs(*c.weights, tiles * part / parts, tiles * (part + 1) / parts, a);
    tile_unit()->multiply(a);
  });
}

}  // namespace penumbra::nn
