#include "nn/layers/winograd.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/base/half.h"
#include "nn/base/parallel.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

constexpr int kOut = kWinogradOutput, kIn = kWinogradInput;

// Numbers of a block of tiles that one thread works on alone: they fit into its L2 cache, transformed inputs
// and products together.
constexpr std::size_t kOwnBlockFloats = 256 * 1024;
// And those of a block that all threads share, in the L3 cache.
constexpr std::size_t kSharedBlockFloats = 3 * 1024 * 1024;
// With more channels than this the weights of all positions pass L2; blocks are shared then, so that each
// weight serves more tiles.
constexpr int kMostOwnChannels = 128;

}  // namespace

bool winograd_pays(int channels, int outputs) {
  return channels >= 32 && outputs >= 32 && channels <= 384 && outputs <= 384;
}

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

Winograd::Winograd(const Tensor& weight, const std::vector<float>& bias, Precision precision) {
  const int outputs = static_cast<int>(weight.extent(0)), channels = static_cast<int>(weight.extent(1));
  input_blocks_ = ceil_div(channels, kBlock);
  output_blocks_ = ceil_div(outputs, kBlock);
  bias_.assign(static_cast<std::size_t>(output_blocks_) * kBlock, 0.0F);
  std::copy(bias.begin(), bias.end(), bias_.begin());
  layout_ = PackedWeights(outputs, input_blocks_, kBlock, NumberFormat{precision, {}, nullptr});
  const std::size_t row = static_cast<std::size_t>(input_blocks_) * kBlock * kWinogradKernel;  // of an output
  kernels_ = WeightMemory(bias_.size() * row * sizeof(float));
  parallel_for(layout_.tiles(), 1, [&](int t) {
    const int first = t * layout_.tile_channels();
    const int width = std::min(layout_.tile_channels(), static_cast<int>(bias_.size()) - first);
    float* out = reinterpret_cast<float*>(kernels_.data()) + static_cast<std::size_t>(first) * row;
    std::fill_n(out, row * static_cast<std::size_t>(width), 0.0F);
    const std::ptrdiff_t numbers = std::ptrdiff_t{channels} * kWinogradKernel;
    for (std::ptrdiff_t i = 0; i < numbers; ++i, out += width) {
      const float* in = weight.values.data() + first * numbers + i;
      for (int o = 0; o < std::min(width, outputs - first); ++o) out[o] = in[o * numbers];
    }
  });
}

std::size_t Winograd::position_bytes() const {
  return layout_.bytes() + 64;  // so that positions do not share one set of the cache
}

ArenaBuffer Winograd::prepare(Arena& arena) const {
  const std::size_t stride = position_bytes();
  ArenaBuffer prepared = arena.allocate(stride / sizeof(float) * kWinogradPositions);
  auto* const start = reinterpret_cast<std::byte*>(prepared.data());
  const bool rounded = layout_.format().precision != Precision::f32;
  parallel_for({layout_.tiles(), input_blocks_}, 1, [&](int t, int tap) {
    const WeightTile tile = layout_.tile(t, start);
    // The tile's part of a position, in numbers from its start; of the kernels nine times as far.
    const std::ptrdiff_t place = (static_cast<std::ptrdiff_t>(t) * layout_.tile_channels() * input_blocks_ +
                                  static_cast<std::ptrdiff_t>(tap) * tile.channels) *
                                 kBlock;
    WinogradWeightArguments a;
    a.channels = tile.channels;
    a.input = reinterpret_cast<const float*>(kernels_.data()) + place * kWinogradKernel;
    if (!rounded) {
      a.output = prepared.data() + place;
      a.position_stride = static_cast<std::ptrdiff_t>(stride / sizeof(float));
      a.count = kBlock;
      return kernels().winograd_weights(a);
    }
    // Groups of channels side by side, as layout_ has them in bf16.
    constexpr int kMostGroup = 4;
    const int group = layout_.group();
    float channels[kWinogradPositions][kMostGroup][kMostTileChannels];
    a.position_stride = kMostGroup * kMostTileChannels;
    a.count = 1;
    for (int c = 0; c < kBlock; c += group) {
      for (int i = 0; i < group; ++i, a.input += kWinogradKernel * tile.channels) {
        a.output = &channels[0][i][0];
        kernels().winograd_weights(a);
      }
      for (int k = 0; k < kWinogradPositions; ++k) {
        auto* out = reinterpret_cast<std::uint16_t*>(start + static_cast<std::size_t>(k) * stride) + place +
                    c * tile.channels;
        for (int o = 0; o < tile.channels; ++o) {
          for (int i = 0; i < group; ++i) *out++ = f32_to_bf16(channels[k][i][o]);
        }
      }
    }
  });
  return prepared;
}

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
  const int own = tiles_in(kOwnBlockFloats);
  const bool alone =
      std::max(input_blocks_, output_blocks_) * kBlock <= kMostOwnChannels && most_tiles >= 2 * threads * own;
  work.block_tiles =
      std::min(alone ? own : tiles_in(kSharedBlockFloats), std::max(ceil_div(most_tiles, step), 1) * step);

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
    const bool fits = y + kIn <= bottom && x + kIn <= right;
    const int whole = fits ? std::min((right - x - kIn) / kOut + 1, tiles) : 0;
    if (whole > 0) {
      a.input = input.pixel(n, channel_block, y, x);
      a.row_stride = input.row_stride();
      a.tiles = whole;
      kernels().winograd_input(a);
      a.output += static_cast<std::ptrdiff_t>(whole) * kBlock;
    }
    // The others are copied, with zeros where they reach beyond.
    for (int i = whole; i < tiles; ++i, a.output += kBlock) {
      alignas(64) float patch[kIn * kIn * kBlock] = {};
      const int left = x + i * kOut, columns = std::clamp(right - left, 0, kIn);
      for (int u = 0; u < kIn && y + u < bottom; ++u) {
        std::memcpy(patch + u * kIn * kBlock, input.pixel(n, channel_block, y + u, left),
                    static_cast<std::size_t>(columns) * kBlock * sizeof(float));
      }
      a.input = patch;
      a.row_stride = kIn * kBlock;
      a.tiles = 1;
      kernels().winograd_input(a);
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
  work.for_each_run(first, count, [&](int t, int n, int row, int column, int tiles) {
    const int y = row * kOut, x = column * kOut;
    WinogradOutputArguments a;
    a.input = work.products + (static_cast<std::ptrdiff_t>(channel_block) * work.block_tiles + t) * kBlock;
    a.position_stride = work.product_stride;
    a.tiles = tiles;
    a.bias = bias_.data() + static_cast<std::ptrdiff_t>(channel_block) * kBlock;
    a.output = output.pixel(n, channel_block, y, x);
    a.output_row_stride = output.row_stride();
    if (work.residual != nullptr) {
      a.residual = work.residual->pixel(n, channel_block, y, x);
      a.residual_row_stride = work.residual->row_stride();
    }
    a.rows = std::min(kOut, output.height() - y);
    a.columns = std::min(tiles * kOut, output.width() - x);
    a.lower_bound = work.lower_bound;
    kernels().winograd_output(a);
  });
}

}  // namespace penumbra::nn
