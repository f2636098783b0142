#include "nn/layers/direct_convolution.h"

#include <algorithm>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

// A task's input: half of a 1 MB L2, the weights of a tile have the other half.
constexpr std::ptrdiff_t kPatchBytes = 384 * 1024;
constexpr int kPatchRows = 4;  // of the output, for kernels that share rows of the input
// Tasks a thread at least, so that the last one to finish leaves the others idle for little.
constexpr int kTasksPerThread = 12;
// Over images: 64 taps of 16 channels by 32 outputs are 131 KB of f32 weights.
constexpr int kTapsPerPanel = 64;
constexpr int kTilesOfImages = 8;
constexpr int kTilesPerTask = 4;

float lower_bound(Activation activation) {
  return activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
}

// ReLU is part of the tile kernel; the others pass over a task's new pixels while these are in the cache.
bool after_kernel(Activation activation) {
  return activation != Activation::none && activation != Activation::relu;
}

// The output's pixels as rows of columns, cut into segments of at most one tile, and these into patches.
struct Patches {
  int rows, columns;
  int segments;                     // of a row, as even as can be
  int patch_rows, patch_segments;   // of a task
  int row_patches, column_patches;  // of an image
  int first_column(int segment) const { return static_cast<int>(std::int64_t{columns} * segment / segments); }
};

// Pointwise convolutions of stride 1 between maps without borders see one long row.
bool is_flat(const DirectConvolution& c) {
  const bool pointwise = c.stride == 1 && c.padding == 0 && c.input->height() == c.output->height() &&
                         c.input->width() == c.output->width();
  return pointwise && c.input->border() == 0 && c.output->border() == 0 &&
         (c.residual == nullptr || c.residual->border() == 0);
}

Patches make_patches(const DirectConvolution& c) {
  const PackedWeights& weights = c.groups.front();
  Patches p{};
  const bool flat = is_flat(c);
  p.rows = flat ? 1 : c.output->height();
  p.columns = flat ? c.output->height() * c.output->width() : c.output->width();
  p.segments = ceil_div(p.columns, weights.tile_pixels());
  const int group_blocks = ceil_div(c.input->blocks(), static_cast<int>(c.groups.size()));
  const std::ptrdiff_t pixel_bytes = static_cast<std::ptrdiff_t>(group_blocks) * c.input->block() * c.stride *
                                     c.stride * element_size(weights.format().precision);
  const auto segments = static_cast<int>(kPatchBytes / (pixel_bytes * weights.tile_pixels()));
  p.patch_rows = std::min(p.rows, kPatchRows);
  p.patch_segments = std::clamp(segments / p.patch_rows, 1, p.segments);
  p.row_patches = ceil_div(p.rows, p.patch_rows);
  p.column_patches = ceil_div(p.segments, p.patch_segments);
  return p;
}

// `channels` of a tile from (y, x) on, `columns` pixels, in place.
void activate_pixels(const DirectConvolution& c, int n, int block, const WeightTile& tile, int y, int x,
                     int columns) {
  for (int first = 0; first < tile.channels; first += kBlock) {
    float* values = c.output->pixel(n, block + first / kBlock, y, x) + tile.lane;
    const int lanes = std::min(tile.channels, kBlock);
    if (lanes == kBlock) {
      activate(values, static_cast<std::ptrdiff_t>(columns) * kBlock, c.activation, c.slope);
      continue;
    }
    for (int i = 0; i < columns; ++i, values += kBlock) activate(values, lanes, c.activation, c.slope);
  }
}

}  // namespace

void convolve_pixels(const DirectConvolution& c) {
  const FeatureMap& input = *c.input;
  FeatureMap& output = *c.output;
  const Patches patches = make_patches(c);
  const int groups = static_cast<int>(c.groups.size()), group_tiles = c.groups.front().tiles();
  const int group_inputs = input.blocks() / groups, group_outputs = output.blocks() / groups;
  const int bytes = element_size(c.groups.front().format().precision);
  const int tiles = group_tiles * groups;
  // Where patches are few, a task has some of the tiles only.
  const std::int64_t image_patches =
      std::int64_t{output.images()} * patches.row_patches * patches.column_patches;
  const std::int64_t wanted = std::int64_t{kTasksPerThread} * thread_count();
  const int parts = static_cast<int>(
      std::clamp(ceil_div(static_cast<int>(std::min(wanted, std::int64_t{1} << 20)),
                          static_cast<int>(std::clamp(image_patches, std::int64_t{1}, wanted))),
                 1, tiles));

  const int extents[] = {output.images(), patches.row_patches, patches.column_patches, parts};
  parallel_for(extents, 1, [&](int n, int row_patch, int column_patch, int part) {
    const int first_row = row_patch * patches.patch_rows;
    const int end_row = std::min(first_row + patches.patch_rows, patches.rows);
    const int first_segment = column_patch * patches.patch_segments;
    const int end_segment = std::min(first_segment + patches.patch_segments, patches.segments);
    for (int t = tiles * part / parts; t < tiles * (part + 1) / parts; ++t) {
      const int g = t / group_tiles;
      const PackedWeights& weights = c.groups[static_cast<std::size_t>(g)];
      const WeightTile tile = weights.tile(t % group_tiles);
      const int block = g * group_outputs + tile.block;
      TileArguments a;
      weights.prepare(tile, 0, weights.taps(), a);
      a.taps = c.taps;
      a.input_pixel_stride = static_cast<std::ptrdiff_t>(c.stride) * input.block();
      a.output_pixel_stride = output.block();
      a.output_block_stride = output.block_stride();
      a.lower_bound = lower_bound(c.activation);
      if (c.residual != nullptr) {
        a.residual_pixel_stride = c.residual->block();
        a.residual_block_stride = c.residual->block_stride();
      }
      for (int y = first_row; y < end_row; ++y) {
        for (int s = first_segment; s < end_segment; ++s) {
          const int x = patches.first_column(s);
          a.input = c.values + bytes * input.offset(n, g * group_inputs, y * c.stride - c.padding,
                                                    x * c.stride - c.padding);
          a.output = output.pixel(n, block, y, x) + tile.lane;
          if (c.residual != nullptr) a.residual = c.residual->pixel(n, block, y, x) + tile.lane;
          weights.kernel(tile, patches.first_column(s + 1) - x)(a);
        }
        if (after_kernel(c.activation)) {
          const int x = patches.first_column(first_segment), end = patches.first_column(end_segment);
          activate_pixels(c, n, block, tile, y, x, end - x);
        }
      }
    }
  });
}

void convolve_images(const DirectConvolution& c) {
  const FeatureMap& input = *c.input;
  FeatureMap& output = *c.output;
  const PackedWeights& weights = c.groups.front();
  const int bytes = element_size(weights.format().precision);
  const int images = output.images(), step = weights.tile_pixels();
  const int image_groups = ceil_div(images, step * kTilesOfImages);
  const int tile_groups = ceil_div(weights.tiles(), kTilesPerTask);

  parallel_for({image_groups, tile_groups}, 1, [&](int image_group, int tile_group) {
    const int first_image = images * image_group / image_groups;
    const int end_image = images * (image_group + 1) / image_groups;
    const int end_tile = std::min((tile_group + 1) * kTilesPerTask, weights.tiles());
    for (int first_tap = 0; first_tap < weights.taps(); first_tap += kTapsPerPanel) {
      const int taps = std::min(kTapsPerPanel, weights.taps() - first_tap);
      const bool last = first_tap + taps == weights.taps();
      for (int t = tile_group * kTilesPerTask; t < end_tile; ++t) {
        const WeightTile tile = weights.tile(t);
        TileArguments a;
        weights.prepare(tile, first_tap, taps, a);
        a.taps = c.taps + first_tap;
        a.input_pixel_stride = input.image_stride();
        a.output_pixel_stride = output.image_stride();
        a.output_block_stride = output.block_stride();
        a.accumulate = first_tap > 0;
        a.lower_bound = lower_bound(last ? c.activation : Activation::none);
        const FeatureMap* residual = last ? c.residual : nullptr;
        if (residual != nullptr) {
          a.residual_pixel_stride = residual->image_stride();
          a.residual_block_stride = residual->block_stride();
        }
        for (int n = first_image; n < end_image; n += step) {
          a.input = c.values + bytes * input.offset(n, 0, -c.padding, -c.padding);
          a.output = output.pixel(n, tile.block, 0, 0) + tile.lane;
          if (residual != nullptr) a.residual = residual->pixel(n, tile.block, 0, 0) + tile.lane;
          weights.kernel(tile, std::min(step, end_image - n))(a);
        }
      }
    }
  });
  if (after_kernel(c.activation)) activate(output, c.activation, c.slope);
}

}  // namespace penumbra::nn
