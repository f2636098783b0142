#include "nn/layers/conv2d.h"

#include <algorithm>
#include <limits>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

// Rows of the output that a task computes with one tile of weights: enough to reuse the weights from L2, few
// enough that the rows of the input stay there too.
constexpr int kRowsPerTask = 4;
// Fully connected layers: images a task, and taps between stores of the sums. 64 taps of 16 channels by 32
// outputs are 131 KB of weights, which stay in L2 while the images pass.
constexpr int kImagesPerTask = 56;
constexpr int kTapsPerPass = 64;
constexpr int kTileGroups = 2;

float lower_bound(Activation activation) {
  return activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
}

// ReLU is part of the tile kernel; the others pass over a row's new pixels while these are in the cache.
bool after_kernel(Activation activation) {
  return activation != Activation::none && activation != Activation::relu;
}

// `channels` from `first` on of row y, in place.
void activate_row(FeatureMap& map, int n, int y, int first, int channels, const Conv2dOptions& options) {
  for (int c = first; c < first + channels; c += kBlock) {
    const int lanes = std::min(channels, kBlock);
    float* values = map.pixel(n, c / kBlock, y, 0) + c % kBlock;
    if (lanes == kBlock) {
      activate(values, static_cast<std::ptrdiff_t>(map.width()) * kBlock, options.activation, options.slope);
      continue;
    }
    for (int x = 0; x < map.width(); ++x, values += kBlock) {
      activate(values, lanes, options.activation, options.slope);
    }
  }
}

int ceil_div(int a, int b) { return (a + b - 1) / b; }

}  // namespace

Conv2d::Conv2d(const Tensor& weight, const std::vector<float>& bias, Conv2dOptions options, int input_block)
    : options_(options), input_block_(input_block) {
  if (weight.shape.size() != 4) throw InputError("conv2d", "a weight [O, C, K, K]", to_string(weight.shape));
  outputs_ = static_cast<int>(weight.extent(0));
  kernel_height_ = static_cast<int>(weight.extent(2));
  kernel_width_ = static_cast<int>(weight.extent(3));
  if (!bias.empty() && static_cast<int>(bias.size()) != outputs_) {
    throw InputError("conv2d", fmt::format("{} biases", outputs_), fmt::format("{}", bias.size()));
  }
  const int groups = options.groups;
  if (groups < 1 || outputs_ % groups != 0 || (groups > 1 && input_block != kBlock)) {
    throw InputError("conv2d", fmt::format("groups that divide {} output channels", outputs_),
                     fmt::format("{} in blocks of {}", groups, input_block));
  }
  const int group_inputs = static_cast<int>(weight.extent(1)), group_outputs = outputs_ / groups;
  input_channels_ = group_inputs * groups;
  if (groups > 1 && (group_inputs % kBlock != 0 || group_outputs % kBlock != 0)) {
    narrow_ = NarrowGroups(weight, bias, groups);
    return;
  }
  const int input_blocks = ceil_div(group_inputs, input_block);
  if (input_block == kImageBlock) {
    // The pixels of a kernel row lie side by side: one tap a row, of K_w * 4 channels.
    if (options.dilation != 1)
      throw InputError("conv2d over images", "dilation 1", fmt::format("{}", options.dilation));
    groups_.emplace_back(
        outputs_, input_blocks * kernel_height_, kernel_width_ * input_block,
        [&](int o, int tap, int c) {
          const int channel = tap / kernel_height_ * input_block + c % input_block;
          return channel < input_channels_ ? weight.at(o, channel, tap % kernel_height_, c / input_block)
                                           : 0.0F;
        },
        bias);
    return;
  }
  const int positions = kernel_height_ * kernel_width_;
  for (int g = 0; g < groups; ++g) {
    const int first = g * group_outputs;
    groups_.emplace_back(
        group_outputs, input_blocks * positions, input_block,
        [&](int o, int tap, int c) {
          const int channel = tap / positions * input_block + c, position = tap % positions;
          return channel < group_inputs
                     ? weight.at(first + o, channel, position / kernel_width_, position % kernel_width_)
                     : 0.0F;
        },
        bias.empty() ? bias : std::vector<float>(bias.begin() + first, bias.begin() + first + group_outputs));
  }
}

Conv2d::Geometry Conv2d::output_size(int height, int width) const {
  const auto extent = [&](int in, int kernel) {
    return (in + 2 * options_.padding - options_.dilation * (kernel - 1) - 1) / options_.stride + 1;
  };
  return {extent(height, kernel_height_), extent(width, kernel_width_)};
}

double Conv2d::multiply_adds(int height, int width) const {
  const Geometry out = output_size(height, width);
  return static_cast<double>(outputs_) * out.height * out.width * (input_channels_ / options_.groups) *
         kernel_height_ * kernel_width_;
}

FeatureMap Conv2d::operator()(const FeatureMap& input, Arena& arena, int output_border,
                              const FeatureMap* residual) const {
  if (input.channels() != input_channels_ || input.block() != input_block_) {
    throw InputError("conv2d",
                     fmt::format("{} input channels in blocks of {}", input_channels_, input_block_),
                     fmt::format("{} in blocks of {}", input.channels(), input.block()));
  }
  if (input.border() < options_.padding) {
    return (*this)(with_border(input, arena, options_.padding), arena, output_border, residual);
  }
  const Geometry out = output_size(input.height(), input.width());
  if (out.height < 1 || out.width < 1) {
    throw InputError("conv2d",
                     fmt::format("an input that covers the {} x {} kernel", kernel_height_, kernel_width_),
                     fmt::format("{} x {} with padding {}", input.height(), input.width(), options_.padding));
  }

  FeatureMap output(arena, input.batch(), outputs_, out.height, out.width, output_border);
  if (groups_.empty()) {
    over_rows(input, residual, output);
    return output;
  }
  const int tap_count = groups_.front().taps();
  const ArenaBuffer tap_memory = arena.allocate(static_cast<std::size_t>(tap_count) * 2);
  auto* taps = reinterpret_cast<std::ptrdiff_t*>(tap_memory.data());
  const bool row_taps = input_block_ == kImageBlock;  // a tap holds a whole kernel row
  const int group_blocks = input.blocks() / options_.groups;
  std::ptrdiff_t* next = taps;
  for (int b = 0; b < group_blocks; ++b) {
    for (int u = 0; u < kernel_height_; ++u) {
      for (int v = 0; v < (row_taps ? 1 : kernel_width_); ++v) {
        *next++ = b * input.block_stride() + u * options_.dilation * input.row_stride() +
                  static_cast<std::ptrdiff_t>(v) * options_.dilation * input.block();
      }
    }
  }
  if (out.height == 1 && out.width == 1 && output_border == 0 && options_.groups == 1) {
    over_images(input, taps, residual, output);
    if (after_kernel(options_.activation)) activate(output, options_.activation, options_.slope);
  } else {
    over_pixels(input, taps, residual, output);
  }
  return output;
}

void Conv2d::over_pixels(const FeatureMap& input, const std::ptrdiff_t* taps, const FeatureMap* residual,
                         FeatureMap& output) const {
  const int height = output.height(), width = output.width();
  const int group_tiles = groups_.front().tiles(), tiles = group_tiles * options_.groups;
  const int group_inputs = input.blocks() / options_.groups,
            group_outputs = output.blocks() / options_.groups;
  const int row_groups = ceil_div(height, kRowsPerTask);
  const int segments = ceil_div(width, groups_.front().tile_pixels());  // of a row, as even as can be

#pragma omp parallel for collapse(3) schedule(dynamic)
  for (int n = 0; n < output.images(); ++n) {
    for (int group = 0; group < row_groups; ++group) {
      for (int t = 0; t < tiles; ++t) {
        const int g = t / group_tiles;
        const PackedWeights& weights = groups_[static_cast<std::size_t>(g)];
        const WeightTile tile = weights.tile(t % group_tiles);
        const int block = g * group_outputs + tile.block;
        TileArguments a;
        a.input_pixel_stride = static_cast<std::ptrdiff_t>(options_.stride) * input.block();
        a.taps = taps;
        a.tap_count = weights.taps();
        a.depth = weights.depth();
        a.weights = tile.weights;
        a.bias = tile.bias;
        a.output_pixel_stride = output.block();
        a.output_block_stride = output.block_stride();
        a.lower_bound = lower_bound(options_.activation);
        if (residual != nullptr) {
          a.residual_pixel_stride = residual->block();
          a.residual_block_stride = residual->block_stride();
        }
        for (int y = group * kRowsPerTask; y < std::min((group + 1) * kRowsPerTask, height); ++y) {
          for (int s = 0; s < segments; ++s) {
            const int x = width * s / segments, end = width * (s + 1) / segments;
            a.input = input.pixel(n, g * group_inputs, y * options_.stride - options_.padding,
                                  x * options_.stride - options_.padding);
            a.output = output.pixel(n, block, y, x) + tile.lane;
            if (residual != nullptr) a.residual = residual->pixel(n, block, y, x) + tile.lane;
            weights.kernel(tile, end - x)(a);
          }
          if (after_kernel(options_.activation)) {
            const int channels = tile.narrow ? kBlock : kernels().tile_channels;
            activate_row(output, n, y, block * kBlock + tile.lane, channels, options_);
          }
        }
      }
    }
  }
}

void Conv2d::over_images(const FeatureMap& input, const std::ptrdiff_t* taps, const FeatureMap* residual,
                         FeatureMap& output) const {
  const PackedWeights& weights = groups_.front();
  const int tiles = weights.tiles(), images = output.images(), step = weights.tile_pixels();
  const int image_groups = ceil_div(images, kImagesPerTask);

#pragma omp parallel for collapse(2) schedule(dynamic)
  for (int group = 0; group < image_groups; ++group) {
    for (int half = 0; half < kTileGroups; ++half) {
      for (int first_tap = 0; first_tap < weights.taps(); first_tap += kTapsPerPass) {
        const int pass_taps = std::min(kTapsPerPass, weights.taps() - first_tap);
        const bool last = first_tap + pass_taps == weights.taps();
        for (int t = tiles * half / kTileGroups; t < tiles * (half + 1) / kTileGroups; ++t) {
          const WeightTile tile = weights.tile(t);
          const int tile_channels = tile.narrow ? kBlock : kernels().tile_channels;
          TileArguments a;
          a.input_pixel_stride = input.image_stride();
          a.taps = taps + first_tap;
          a.tap_count = pass_taps;
          a.depth = weights.depth();
          a.weights = tile.weights + static_cast<std::ptrdiff_t>(first_tap) * weights.depth() * tile_channels;
          a.bias = tile.bias;
          a.output_pixel_stride = output.image_stride();
          a.output_block_stride = output.block_stride();
          a.accumulate = first_tap > 0;
          a.lower_bound = lower_bound(last ? options_.activation : Activation::none);
          if (last && residual != nullptr) {
            a.residual_pixel_stride = residual->image_stride();
            a.residual_block_stride = residual->block_stride();
          }
          for (int n = group * kImagesPerTask; n < std::min((group + 1) * kImagesPerTask, images);
               n += step) {
            a.input = input.pixel(n, 0, -options_.padding, -options_.padding);
            a.output = output.pixel(n, tile.block, 0, 0) + tile.lane;
            if (last && residual != nullptr) a.residual = residual->pixel(n, tile.block, 0, 0) + tile.lane;
            const int end = std::min({n + step, (group + 1) * kImagesPerTask, images});
            weights.kernel(tile, end - n)(a);
          }
        }
      }
    }
  }
}

void Conv2d::over_rows(const FeatureMap& input, const FeatureMap* residual, FeatureMap& output) const {
#pragma omp parallel for collapse(3) schedule(dynamic, 4)
  for (int n = 0; n < output.images(); ++n) {
    for (int b = 0; b < output.blocks(); ++b) {
      for (int y = 0; y < output.height(); ++y) {
        narrow_.row(input, options_.stride, options_.padding, options_.dilation, n, b, y, output);
        float* out = output.pixel(n, b, y, 0);
        const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(output.width()) * kBlock;
        if (residual != nullptr) {
          const float* r = residual->pixel(n, b, y, 0);
          for (std::ptrdiff_t i = 0; i < count; ++i) out[i] += r[i];
        }
        activate(out, count, options_.activation, options_.slope);
      }
    }
  }
}

Conv2d linear(const Tensor& weight, const std::vector<float>& bias, int channels, int height, int width,
              Activation activation) {
  const std::int64_t inputs = static_cast<std::int64_t>(channels) * height * width;
  if (weight.shape.size() != 2 || weight.extent(1) != inputs) {
    throw InputError("linear", fmt::format("a weight [O, {}]", inputs), to_string(weight.shape));
  }
  Conv2dOptions options;
  options.activation = activation;
  return {Tensor({weight.extent(0), channels, height, width}, weight.values), bias, options};
}

}  // namespace penumbra::nn
