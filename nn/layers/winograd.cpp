#include "nn/layers/winograd.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

constexpr int kOut = kWinogradOutput, kIn = kWinogradInput;

// G takes a kernel's 3 numbers to 6: (1, p, p^2) / N_p for each point p.
constexpr double kA = kWinogradA, kB = kWinogradB, kA2 = kA * kA, kB2 = kB * kB;
constexpr double kN0 = kA2 * kB2, kNa = 2 * kA2 * (kA2 - kB2), kNb = 2 * kB2 * (kB2 - kA2);
constexpr double kG[kIn][3] = {{1 / kN0, 0, 0},
                               {1 / kNa, kA / kNa, kA2 / kNa},
                               {1 / kNa, -kA / kNa, kA2 / kNa},
                               {1 / kNb, kB / kNb, kB2 / kNb},
                               {1 / kNb, -kB / kNb, kB2 / kNb},
                               {0, 0, 1}};

// G g G^T of one kernel.
std::array<float, kWinogradPositions> transform_kernel(const float* g) {
  double rows[kIn][3];
  for (int i = 0; i < kIn; ++i) {
    for (int v = 0; v < 3; ++v) rows[i][v] = kG[i][0] * g[v] + kG[i][1] * g[3 + v] + kG[i][2] * g[6 + v];
  }
  std::array<float, kWinogradPositions> result{};
  for (int i = 0; i < kIn; ++i) {
    for (int j = 0; j < kIn; ++j) {
      result[static_cast<std::size_t>(i * kIn + j)] =
          static_cast<float>(kG[j][0] * rows[i][0] + kG[j][1] * rows[i][1] + kG[j][2] * rows[i][2]);
    }
  }
  return result;
}

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
  const auto pairs = static_cast<std::size_t>(outputs) * static_cast<std::size_t>(channels);
  std::vector<float> transformed(pairs * kWinogradPositions);  // [position][o][c]
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    const auto kernel = transform_kernel(weight.values.data() + pair * 9);
    for (std::size_t k = 0; k < kWinogradPositions; ++k) transformed[k * pairs + pair] = kernel[k];
  }
  for (std::size_t k = 0; k < kWinogradPositions; ++k) {
    const float* values = transformed.data() + k * pairs;
    weights_.emplace_back(
        outputs, input_blocks_, kBlock,
        [&](int o, int tap, int c) {
          const int channel = tap * kBlock + c;
          return channel < channels ? values[static_cast<std::ptrdiff_t>(o) * channels + channel] : 0.0F;
        },
        std::vector<float>{}, NumberFormat{precision, {}, nullptr});
  }
}

void Winograd::operator()(const FeatureMap& input, int padding, Activation activation,
                          const FeatureMap* residual, FeatureMap& output, Arena& arena) const {
  const int threads = omp_get_max_threads();
  Work work{};
  work.input = &input;
  work.residual = residual;
  work.output = &output;
  work.padding = padding;
  work.lower_bound = activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
  work.tile_columns = ceil_div(output.width(), kOut);
  work.image_tiles = work.tile_columns * ceil_div(output.height(), kOut);
  const int tiles = work.image_tiles * output.images();
  const int most_tiles = work.image_tiles * output.batch().capacity;  // which decides about memory

  // Tiles a block: whole register tiles.
  const int step = weights_.front().tile_pixels();
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
  const bool low_precision = weights_.front().format().precision != Precision::f32;
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
#pragma omp parallel
    {
      Work own_work = work;
      own_work.inputs = scratch.data() + floats * static_cast<std::size_t>(omp_get_thread_num());
      own_work.products = own_work.inputs + input_floats;
#pragma omp for schedule(dynamic)
      for (int block = 0; block < blocks; ++block) {
        const int first = block * work.block_tiles, count = block_size(block);
        for (int b = 0; b < input_blocks_; ++b) transform_inputs(own_work, first, count, b);
        for (int k = 0; k < kWinogradPositions; ++k) multiply(own_work, count, k);
        for (int b = 0; b < output_blocks_; ++b) transform_outputs(own_work, first, count, b);
      }
    }
    return;
  }
  work.inputs = scratch.data();
  work.products = work.inputs + input_floats;
#pragma omp parallel
  for (int block = 0; block < blocks; ++block) {
    const int first = block * work.block_tiles, count = block_size(block);
#pragma omp for schedule(dynamic)
    for (int b = 0; b < input_blocks_; ++b) transform_inputs(work, first, count, b);
#pragma omp for schedule(dynamic)
    for (int k = 0; k < kWinogradPositions; ++k) multiply(work, count, k);
#pragma omp for schedule(dynamic)
    for (int b = 0; b < output_blocks_; ++b) transform_outputs(work, first, count, b);
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

void Winograd::multiply(const Work& work, int count, int position) const {
  const PackedWeights& weights = weights_[static_cast<std::size_t>(position)];
  const int step = weights.tile_pixels();
  const float* inputs = work.inputs + position * work.input_stride;
  const std::byte* values = reinterpret_cast<const std::byte*>(inputs);
  const Precision precision = weights.format().precision;
  if (precision != Precision::f32) {
    float* own = work.converted + omp_get_thread_num() * work.input_stride;
    low_precision_kernels(precision).convert(inputs, work.input_stride, {}, own);
    values = reinterpret_cast<const std::byte*>(own);
  }
  TileArguments a;
  a.taps = work.taps;
  a.input_pixel_stride = a.output_pixel_stride = kBlock;
  a.output_block_stride = static_cast<std::ptrdiff_t>(work.block_tiles) * kBlock;
  a.lower_bound = -std::numeric_limits<float>::infinity();
  for (int t = 0; t < weights.tiles(); ++t) {
    const WeightTile tile = weights.tile(t);
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
