#include "nn/layers/winograd.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/base/parallel.h"
#include "nn/simd/tile_unit.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

constexpr int kOut = kWinogradOutput, kIn = kWinogradInput;

// Numbers of a block of tiles that one thread works on alone: they fit into its L2 cache, transformed inputs
// and products together.
constexpr std::size_t kOwnBlockFloats = 256 * 1024;
// And those of a block that all threads share, in the L3 cache, for each byte of a weight: the smaller these
// are, the fewer tiles pay for reading them.
constexpr std::size_t kSharedFloatsPerWeightByte = 2 * 1024 * 1024 / sizeof(float);
// With more channels than this the weights of all positions pass L2; blocks are shared then, so that each
// weight serves more tiles.
constexpr int kMostOwnChannels = 128;

// Tiles of a row that are widened or copied at a time: 13 KB.
constexpr int kCopiedTiles = 8, kCopiedColumns = kCopiedTiles * kOut + kIn - kOut;

// Where 16 channels of a map's pixels lie: a block of f32, or a half of a line of bf16.
std::ptrdiff_t half_line(const FeatureMap& map, int channel_block) {
  return channel_block * kBlock % map.block() * element_size(map.numbers().precision);
}

LineLayout layout_of_pixels(const Numbers& numbers) { return {kLineBytes, 0, numbers}; }

// `columns` pixels of 16 channels from (y, x) on, as f32 side by side.
void read_pixels(const FeatureMap& map, int n, int channel_block, int y, int x, int columns, float* to) {
  const std::byte* from = map.line(n, channel_block * kBlock / map.block(), y, x);
  if (map.numbers().precision == Precision::f32) {
    std::memcpy(to, from, static_cast<std::size_t>(columns) * kLineBytes);
    return;
  }
  line_kernels()->convert_lines({from + half_line(map, channel_block), layout_of_pixels(map.numbers()),
                                 kBlock, reinterpret_cast<std::byte*>(to), layout_of_pixels({}), kBlock,
                                 columns});
}

// And back.
void write_pixels(const float* from, FeatureMap& map, int n, int channel_block, int y, int x, int columns) {
  std::byte* const to = map.line(n, channel_block * kBlock / map.block(), y, x);
  if (map.numbers().precision == Precision::f32) {
    std::memcpy(to, from, static_cast<std::size_t>(columns) * kLineBytes);
    return;
  }
  line_kernels()->convert_lines({reinterpret_cast<const std::byte*>(from), layout_of_pixels({}), kBlock,
                                 to + half_line(map, channel_block), layout_of_pixels(map.numbers()), kBlock,
                                 columns});
}

}  // namespace

// What one call works on.
struct Winograd::Work {
  const FeatureMap* input;
  const FeatureMap* residual;
  FeatureMap* output;
  int padding;
  float lower_bound;
  int tile_columns, image_tiles;  // tiles in a row and in an image
  int block_tiles;                // most a block
  const std::ptrdiff_t* taps;     // of the products: one block of 16 channels each
  const std::byte* weights;       // transformed
  // Scratch memory: transformed inputs [position][C / 16][block_tiles][16], products the same with O.
  float* inputs;
  float* products;
  std::ptrdiff_t input_stride, product_stride;  // from a position to the next
  float* converted;                             // by threads: the inputs of a position in bf16, where the
                                                // products are

  // Calls run(tile in block, image, row, column, tiles) for the stretches of the block's tiles that lie side
  // by side.
  template <class Function>
  void for_each_run(int first, int count, Function run) const {
    for (int t = 0; t < count;) {
      const int tile = (first + t) % image_tiles, column = tile % tile_columns;
      const int length = std::min(tile_columns - column, count - t);
      run(t, (first + t) / image_tiles, tile / tile_columns, column, length);
      t += length;
    }
  }
};

void Winograd::operator()(const FeatureMap& input, int padding, Activation activation,
                          const FeatureMap* residual, FeatureMap& output, Arena& arena,
                          const ArenaBuffer& prepared) const {
  const int threads = thread_count();
  Work work{};
  work.input = &input;
  work.residual = residual;
  work.output = &output;
  work.weights = reinterpret_cast<const std::byte*>(prepared.data());
  work.padding = padding;
  work.lower_bound = activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
  work.tile_columns = ceil_div(output.width(), kOut);
  work.image_tiles = work.tile_columns * ceil_div(output.height(), kOut);
  const int tiles = work.image_tiles * output.images();
  const int most_tiles = work.image_tiles * output.batch().capacity;  // which decides about memory

  // Tiles a block: whole register tiles.
  const int step = layout_.tile_pixels();
  const std::size_t tile_floats =
      static_cast<std::size_t>(input_blocks_ + output_blocks_) * kBlock * kWinogradPositions;
  const auto tiles_in = [&](std::size_t floats) {
    return std::max(static_cast<int>(floats / tile_floats) / step, 1) * step;
  };
  const auto weight_bytes = static_cast<std::size_t>(element_size(layout_.format().precision));
  const int own = tiles_in(kOwnBlockFloats);
  const bool alone =
      std::max(input_blocks_, output_blocks_) * kBlock <= kMostOwnChannels && most_tiles >= 2 * threads * own;
  work.block_tiles = std::min(alone ? own : tiles_in(kSharedFloatsPerWeightByte * weight_bytes),
                              std::max(ceil_div(most_tiles, step), 1) * step);

  // The 16 floats between positions keep these from sharing one set of the cache.
  work.input_stride = static_cast<std::ptrdiff_t>(input_blocks_) * work.block_tiles * kBlock + kBlock;
  work.product_stride = static_cast<std::ptrdiff_t>(output_blocks_) * work.block_tiles * kBlock + kBlock;
  const auto input_floats = static_cast<std::size_t>(work.input_stride) * kWinogradPositions;
  const auto floats = input_floats + static_cast<std::size_t>(work.product_stride) * kWinogradPositions;
  const bool low_precision = layout_.format().precision != Precision::f32;
  const ArenaBuffer converted = arena.allocate(
      low_precision ? static_cast<std::size_t>(work.input_stride) * static_cast<std::size_t>(threads) : 0);
  work.converted = converted.data();
  const ArenaBuffer scratch = arena.allocate(floats * static_cast<std::size_t>(alone ? threads : 1));
  ArenaVector<std::ptrdiff_t> taps(arena, static_cast<std::size_t>(input_blocks_));
  for (int b = 0; b < input_blocks_; ++b) {
    taps.push_back(static_cast<std::ptrdiff_t>(b) * work.block_tiles * kBlock);
  }
  work.taps = taps.data();
  const int blocks = ceil_div(tiles, work.block_tiles);
  const auto block_size = [&](int block) {
    return std::min(work.block_tiles, tiles - block * work.block_tiles);
  };

  if (alone) {
    parallel_for(blocks, 1, [&](int block, int slot) {
      Work own_work = work;
      own_work.inputs = scratch.data() + floats * static_cast<std::size_t>(slot);
      own_work.products = own_work.inputs + input_floats;
      const int first = block * work.block_tiles, count = block_size(block);
      for (int b = 0; b < input_blocks_; ++b) transform_inputs(own_work, first, count, b);
      for (int k = 0; k < kWinogradPositions; ++k) multiply(own_work, count, k, slot);
      for (int b = 0; b < output_blocks_; ++b) transform_outputs(own_work, first, count, b);
    });
    return;
  }
  work.inputs = scratch.data();
  work.products = work.inputs + input_floats;
  for (int block = 0; block < blocks; ++block) {
    const int first = block * work.block_tiles, count = block_size(block);
    parallel_for(input_blocks_, 1, [&](int b) { transform_inputs(work, first, count, b); });
    parallel_for(kWinogradPositions, 1, [&](int k, int slot) { multiply(work, count, k, slot); });
    parallel_for(output_blocks_, 1, [&](int b) { transform_outputs(work, first, count, b); });
  }
}

void Winograd::transform_inputs(const Work& work, int first, int count, int channel_block) const {
  const FeatureMap& input = *work.input;
  const int bottom = input.height() + input.border(), right = input.width() + input.border();
  work.for_each_run(first, count, [&](int t, int n, int row, int column, int tiles) {
    const int y = row * kOut - work.padding, x = column * kOut - work.padding;
    WinogradInputArguments a;
    a.output = work.inputs + (static_cast<std::ptrdiff_t>(channel_block) * work.block_tiles + t) * kBlock;
    a.position_stride = work.input_stride;
    // Tiles that lie on the map and its border altogether.
    const bool fits = input.numbers().precision == Precision::f32 && y + kIn <= bottom && x + kIn <= right;
    const int whole = fits ? std::min((right - x - kIn) / kOut + 1, tiles) : 0;
    if (whole > 0) {
      a.input = input.pixel(n, channel_block, y, x);
      a.row_stride = input.row_stride();
      a.tiles = whole;
      kernels().winograd_input(a);
      a.output += static_cast<std::ptrdiff_t>(whole) * kBlock;
    }
    // The others are copied as f32, with zeros where they reach beyond.
    for (int i = whole; i < tiles; i += kCopiedTiles) {
      alignas(64) float patch[kIn * kCopiedColumns * kBlock];
      a.tiles = std::min(tiles - i, kCopiedTiles);
      const int left = x + i * kOut, wanted = a.tiles * kOut + kIn - kOut;
      const int columns = std::clamp(right - left, 0, wanted);
      if (columns < wanted || y + kIn > bottom) std::fill(std::begin(patch), std::end(patch), 0.0F);
      for (int u = 0; u < kIn && y + u < bottom; ++u) {
        read_pixels(input, n, channel_block, y + u, left, columns, patch + u * kCopiedColumns * kBlock);
      }
      a.input = patch;
      a.row_stride = kCopiedColumns * kBlock;
      kernels().winograd_input(a);
      a.output += static_cast<std::ptrdiff_t>(a.tiles) * kBlock;
    }
  });
}

void Winograd::multiply(const Work& work, int count, int position, int slot) const {
  const PackedWeights& weights = layout_;
  const std::byte* position_weights = work.weights + static_cast<std::size_t>(position) * position_bytes();
  const int step = weights.tile_pixels();
  const float* inputs = work.inputs + position * work.input_stride;
  const std::byte* values = reinterpret_cast<const std::byte*>(inputs);
  const Precision precision = weights.format().precision;
  if (precision != Precision::f32) {
    float* own = work.converted + slot * work.input_stride;
    low_precision_kernels(precision).convert(inputs, work.input_stride, {}, own);
    values = reinterpret_cast<const std::byte*>(own);
  }
  TileArguments a;
  a.taps = work.taps;
  a.input_pixel_stride = a.output_pixel_stride = kBlock;
  a.output_block_stride = static_cast<std::ptrdiff_t>(work.block_tiles) * kBlock;
  a.lower_bound = -std::numeric_limits<float>::infinity();
  for (int t = 0; t < weights.tiles(); ++t) {
    const WeightTile tile = weights.tile(t, position_weights);
    weights.prepare(tile, 0, weights.taps(), a);
    float* out =
        work.products + position * work.product_stride + tile.block * a.output_block_stride + tile.lane;
    for (int i = 0; i < count; i += step) {
      a.input = values + static_cast<std::ptrdiff_t>(i) * kBlock * element_size(precision);
      a.output = out + static_cast<std::ptrdiff_t>(i) * kBlock;
      weights.kernel(tile, std::min(step, count - i))(a);
    }
  }
}

void Winograd::transform_outputs(const Work& work, int first, int count, int channel_block) const {
  FeatureMap& output = *work.output;
  const FeatureMap* residual = work.residual;
  const auto is_f32 = [](const FeatureMap& map) { return map.numbers().precision == Precision::f32; };
  const bool as_it_is = is_f32(output) && (residual == nullptr || is_f32(*residual));
  work.for_each_run(first, count, [&](int t, int n, int row, int column, int tiles) {
    const int y = row * kOut;
    WinogradOutputArguments a;
    a.input = work.products + (static_cast<std::ptrdiff_t>(channel_block) * work.block_tiles + t) * kBlock;
    a.position_stride = work.product_stride;
    a.bias = bias_.data() + static_cast<std::ptrdiff_t>(channel_block) * kBlock;
    a.rows = std::min(kOut, output.height() - y);
    a.lower_bound = work.lower_bound;
    const int step = as_it_is ? tiles : kCopiedTiles;
    for (int i = 0; i < tiles; i += step, a.input += static_cast<std::ptrdiff_t>(step) * kBlock) {
      const int x = (column + i) * kOut;
      a.tiles = std::min(step, tiles - i);
      a.columns = std::min(a.tiles * kOut, output.width() - x);
      if (as_it_is) {
        a.output = output.pixel(n, channel_block, y, x);
        a.output_row_stride = output.row_stride();
        if (residual != nullptr) {
          a.residual = residual->pixel(n, channel_block, y, x);
          a.residual_row_stride = residual->row_stride();
        }
        kernels().winograd_output(a);
        continue;
      }
      constexpr std::ptrdiff_t kRow = std::ptrdiff_t{kCopiedColumns} * kBlock;
      alignas(64) float under[kOut * kRow], patch[kOut * kRow];
      if (residual != nullptr) {
        for (int u = 0; u < a.rows; ++u)
          read_pixels(*residual, n, channel_block, y + u, x, a.columns, under + u * kRow);
        a.residual = under;
      }
      a.output = patch;
      a.residual_row_stride = a.output_row_stride = kRow;
      kernels().winograd_output(a);
      for (int u = 0; u < a.rows; ++u)
        write_pixels(patch + u * kRow, output, n, channel_block, y + u, x, a.columns);
    }
  });
}

}  // namespace penumbra::nn
