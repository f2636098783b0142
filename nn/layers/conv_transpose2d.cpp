#include "nn/layers/conv_transpose2d.h"

#include <algorithm>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/layers/narrow_maps.h"
#include "nn/layers/tile_convolution.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

// Kernel positions u of one axis that the outputs i = phase (mod stride) meet, and the input that they meet
// there, counted from i div stride.
struct AxisTap {
  int position, offset;
};

std::vector<AxisTap> axis_taps(int phase, int kernel, const ConvTranspose2dOptions& options) {
  std::vector<AxisTap> taps;
  for (int u = 0; u < kernel; ++u) {
    const int distance = phase + options.padding - u * options.dilation;
    if (distance % options.stride == 0) taps.push_back({u, distance / options.stride});
  }
  return taps;
}

}  // namespace

ConvTranspose2d::ConvTranspose2d(const Tensor& weight, const std::vector<float>& bias,
                                 ConvTranspose2dOptions options)
    : options_(options) {
  if (weight.shape.size() != 4) {
    throw InputError("conv_transpose2d", "a weight [C, O, K, K]", to_string(weight.shape));
  }
  input_channels_ = static_cast<int>(weight.extent(0));
  outputs_ = static_cast<int>(weight.extent(1));
  kernel_height_ = static_cast<int>(weight.extent(2));
  kernel_width_ = static_cast<int>(weight.extent(3));
  if (!bias.empty() && static_cast<int>(bias.size()) != outputs_) {
    throw InputError("conv_transpose2d", fmt::format("{} biases", outputs_), fmt::format("{}", bias.size()));
  }
  if (options.stride < 1 || options.dilation < 1 || options.padding < 0 || options.output_padding < 0 ||
      options.output_padding >= std::max(options.stride, options.dilation)) {
    throw InputError("conv_transpose2d",
                     "stride and dilation >= 1, padding >= 0, 0 <= output padding < stride or dilation",
                     fmt::format("{}, {}, {}, {}", options.stride, options.dilation, options.padding,
                                 options.output_padding));
  }
  on_tiles_ = tile_unit() != nullptr && options.format.precision != Precision::f32;
  const int depth = on_tiles_ ? line_channels(options.format.precision) : kBlock;
  const int blocks = ceil_div(input_channels_, depth);
  for (int row = 0; row < options.stride; ++row) {
    for (int column = 0; column < options.stride; ++column) {
      Phase phase{row, column, {}, {}};
      std::vector<Offset> positions;
      for (const AxisTap& u : axis_taps(row, kernel_height_, options)) {
        for (const AxisTap& v : axis_taps(column, kernel_width_, options)) {
          positions.push_back({u.position, v.position});
          phase.offsets.push_back({u.offset, v.offset});
        }
      }
      const int count = static_cast<int>(positions.size());
      const std::ptrdiff_t kernel = std::ptrdiff_t{kernel_height_} * kernel_width_;
      WeightSource source{weight.values.data(), kernel, {}};
      for (int tap = 0; tap < blocks * count; ++tap) {
        const Offset& position = positions[static_cast<std::size_t>(tap % count)];
        for (int c = 0; c < depth; ++c) {
          const int channel = tap / count * depth + c;
          source.offsets.push_back(channel < input_channels_
                                       ? channel * outputs_ * kernel + position.y * kernel_width_ + position.x
                                       : WeightSource::kNone);
        }
      }
      phase.weights = PackedWeights(outputs_, blocks * count, depth, source, bias, options.format);
      phases_.push_back(std::move(phase));
    }
  }
}

FeatureMap ConvTranspose2d::operator()(const FeatureMap& input, Arena& arena, int output_border,
                                       const Numbers& output_numbers) const {
  if (on_tiles_ && input.block() != kImageBlock && input.numbers() != input_numbers()) {
    return (*this)(in_numbers(input, input_numbers(), arena), arena, output_border, output_numbers);
  }
  if (input.channels() != input_channels_ || input.block() != line_channels(input_numbers().precision)) {
    throw InputError("conv_transpose2d", fmt::format("{} input channels", input_channels_),
                     fmt::format("{}", input.channels()));
  }
  const auto extent = [&](int in, int kernel) {
    return (in - 1) * options_.stride - 2 * options_.padding + options_.dilation * (kernel - 1) +
           options_.output_padding + 1;
  };
  const int height = extent(input.height(), kernel_height_), width = extent(input.width(), kernel_width_);
  if (height < 1 || width < 1) {
    throw InputError("conv_transpose2d", "padding that leaves some of the output",
                     fmt::format("{} x {} with padding {}", input.height(), input.width(), options_.padding));
  }
  // How far the taps reach beyond the input.
  int border = 0;
  std::size_t most_taps = 0;
  for (const Phase& phase : phases_) {
    most_taps = std::max(most_taps, static_cast<std::size_t>(phase.weights.taps()));
    for (const Offset& offset : phase.offsets) {
      border = std::max({border, -offset.y, -offset.x,
                         (height - 1) / options_.stride + offset.y - input.height() + 1,
                         (width - 1) / options_.stride + offset.x - input.width() + 1});
    }
  }
  if (input.border() < border) {
    return (*this)(with_border(input, arena, border), arena, output_border, output_numbers);
  }

  FeatureMap output(arena, input.batch(), outputs_, height, width, output_border,
                    on_tiles_ ? output_numbers : Numbers{});
  const ArenaBuffer tap_memory = arena.allocate(most_taps * 2);
  auto* taps = reinterpret_cast<std::ptrdiff_t*>(tap_memory.data());
  observe(input, options_.format);
  const bool as_it_is = on_tiles_ || options_.format.precision == Precision::f32;
  const ArenaBuffer converted = as_it_is ? ArenaBuffer() : convert(input, options_.format, arena);
  const auto* values = reinterpret_cast<const std::byte*>(as_it_is ? input.values() : converted.data());
  for (const Phase& phase : phases_) run_phase(phase, input, values, taps, output, arena);
  if (on_tiles_) return output;
  if (options_.activation != Activation::none && options_.activation != Activation::relu) {
    activate(output, options_.activation, options_.slope);
  }
  return output;
}

void ConvTranspose2d::run_phase(const Phase& phase, const FeatureMap& input, const std::byte* values,
                                std::ptrdiff_t* taps, FeatureMap& output, Arena& arena) const {
  const int bytes = element_size(options_.format.precision);
  const int stride = options_.stride;
  const int rows = ceil_div(output.height() - phase.row, stride);
  const int columns = ceil_div(output.width() - phase.column, stride);
  std::ptrdiff_t* next = taps;
  for (int b = 0; b < input.blocks(); ++b) {
    for (const Offset& offset : phase.offsets) {
      *next++ = (on_tiles_ ? bytes : 1) * (b * input.block_stride() + offset.y * input.row_stride() +
                                           static_cast<std::ptrdiff_t>(offset.x) * input.block());
    }
  }
  if (on_tiles_) {
    TileConvolution convolution;
    convolution.weights = &phase.weights;
    convolution.taps = taps;
    convolution.step = stride;
    convolution.row = phase.row;
    convolution.column = phase.column;
    convolution.activation = options_.activation;
    convolution.slope = options_.slope;
    convolution.input = &input;
    convolution.output = &output;
    convolve_on_tiles(convolution, arena);
    return;
  }
  const int step = phase.weights.tile_pixels(), segments = ceil_div(columns, step);
  parallel_for({input.images(), phase.weights.tiles(), rows}, 1, [&](int n, int t, int y) {
    const WeightTile tile = phase.weights.tile(t);
    TileArguments a;
    a.input_pixel_stride = input.block();
    a.taps = taps;
    phase.weights.prepare(tile, 0, phase.weights.taps(), a);
    a.output_pixel_stride = static_cast<std::ptrdiff_t>(stride) * output.block();
    a.output_block_stride = output.block_stride();
    a.lower_bound = options_.activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity();
    for (int s = 0; s < segments; ++s) {
      const int x = columns * s / segments, end = columns * (s + 1) / segments;
      a.input = values + bytes * input.offset(n, 0, y, x);
      a.output = output.pixel(n, tile.block, y * stride + phase.row, x * stride + phase.column) + tile.lane;
      phase.weights.kernel(tile, end - x)(a);
    }
  });
}

}  // namespace penumbra::nn
