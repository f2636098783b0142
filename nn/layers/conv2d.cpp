#include "nn/layers/conv2d.h"

#include <utility>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/layers/direct_convolution.h"
#include "nn/layers/narrow_maps.h"
#include "nn/layers/tile_convolution.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

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

ArenaBuffer Conv2d::prepare(Arena& arena) const {
  return winograd_.empty() ? ArenaBuffer() : winograd_.prepare(arena);
}

FeatureMap Conv2d::operator()(const FeatureMap& input, Arena& arena, int output_border,
                              const FeatureMap* residual, const Numbers& output_numbers) const {
  return run(input, residual, {arena, prepare(arena), output_border, output_numbers});
}

FeatureMap Conv2d::operator()(FeatureMap&& input, Arena& arena, int output_border, const FeatureMap* residual,
                              const Numbers& output_numbers) const {
  return run(input, residual, {arena, prepare(arena), output_border, output_numbers, &input});
}

FeatureMap Conv2d::onto(FeatureMap residual, const FeatureMap& input, Arena& arena, int output_border,
                        const Numbers& output_numbers) const {
  return run(input, &residual, {arena, prepare(arena), output_border, output_numbers, nullptr, &residual});
}

FeatureMap Conv2d::onto(FeatureMap residual, FeatureMap&& input, Arena& arena, int output_border,
                        const Numbers& output_numbers) const {
  return run(input, &residual, {arena, prepare(arena), output_border, output_numbers, &input, &residual});
}

FeatureMap Conv2d::operator()(const FeatureMap& input, Arena& arena, const ArenaBuffer& prepared,
                              int output_border, const FeatureMap* residual,
                              const Numbers& output_numbers) const {
  return run(input, residual, {arena, prepared, output_border, output_numbers});
}

bool Conv2d::reads(const Numbers& numbers) const {
  return numbers == input_numbers() || (!winograd_.empty() && numbers.precision == Precision::f32);
}

Numbers Conv2d::stores(const Numbers& wanted) const {
  const bool in_one_pass = options_.activation == Activation::none || options_.activation == Activation::relu;
  const bool any = on_tiles_ || (in_one_pass && !winograd_.empty() && winograd_.stores(wanted));
  return any ? wanted : Numbers{};
}

FeatureMap Conv2d::run(const FeatureMap& input, const FeatureMap* residual, const Call& call) const {
  Arena& arena = call.arena;
  const bool image = input_block_ == kImageBlock;
  const bool split = on_tiles_ && image && input.block() == kSplitImageBlock;
  const bool blocks_fit = split || (image ? input.block() == kImageBlock : input.block() >= kBlock);
  if (input.channels() != input_channels_ || !blocks_fit) {
    throw InputError("conv2d",
                     fmt::format("{} input channels in blocks of {}", input_channels_, input_block_),
                     fmt::format("{} in blocks of {}", input.channels(), input.block()));
  }
  // Of a copy, which is the new input, this is the last reader.
  const auto run_on = [&](FeatureMap copy) {
    Call on_copy = call;
    on_copy.last = &copy;
    if (call.last != nullptr) call.last->give_back();
    return run(copy, residual, on_copy);
  };
  if (input.border() < options_.padding) return run_on(with_border(input, arena, options_.padding));
  if (on_tiles_ && image && !split) return run_on(split_image(input, arena));
  if (!image && !reads(input.numbers())) return run_on(in_numbers(input, input_numbers(), arena));
  const Geometry out = output_size(input.height(), input.width());
  if (out.height < 1 || out.width < 1) {
    throw InputError("conv2d",
                     fmt::format("an input that covers the {} x {} kernel", kernel_height_, kernel_width_),
                     fmt::format("{} x {} with padding {}", input.height(), input.width(), options_.padding));
  }
  if (residual != nullptr && !on_tiles_ && winograd_.empty() && residual->numbers() != Numbers{}) {
    FeatureMap wide = in_numbers(*residual, {}, arena);
    Call on_wide = call;
    on_wide.under = &wide;
    if (call.under != nullptr) call.under->give_back();
    return run(input, &wide, on_wide);
  }

  observe(input, options_.format);
  ArenaBuffer converted;
  if (!on_tiles_ && !groups_.empty() && groups_.front().format().precision != Precision::f32) {
    converted = convert(input, groups_.front().format(), arena);
    if (call.last != nullptr) call.last->give_back();
  }
  const Numbers numbers = stores(call.output_numbers);
  FeatureMap output;
  // Layers that keep a part of their sums there (convolve_images, narrow groups) need an output of their own.
  const bool sums_in_output = (winograd_.empty() && groups_.empty()) || (out.height == 1 && out.width == 1);
  if (call.under != nullptr && !on_tiles_ && !sums_in_output && residual->numbers() == numbers &&
      residual->border() == call.output_border && residual->height() == out.height &&
      residual->width() == out.width && residual->channels() == outputs_) {
    output = std::move(*call.under);
    residual = &output;
  } else {
    output = FeatureMap(arena, input.batch(), outputs_, out.height, out.width, call.output_border, numbers);
  }
  if (!winograd_.empty()) {
    winograd_(input, options_.padding, options_.activation, residual, output, arena, call.prepared);
    const bool more = options_.activation != Activation::none && options_.activation != Activation::relu;
    if (more) activate(output, options_.activation, options_.slope);
  } else if (!groups_.empty()) {
    direct(input, converted, residual, output, arena);
  } else {
    over_rows(input, residual, output);
  }
  return output;
}

void Conv2d::direct(const FeatureMap& input, const ArenaBuffer& converted, const FeatureMap* residual,
                    FeatureMap& output, Arena& arena) const {
  const bool image = input_block_ == kImageBlock;  // a tap holds a whole kernel row, or a line of it, twice
  const int columns = !image ? kernel_width_ : on_tiles_ ? 2 * split_row_lines() : 1;
  const auto column_offset = [&](int v) -> std::ptrdiff_t {
    return image ? v / 2 * std::ptrdiff_t{tap_depth()}
                 : std::ptrdiff_t{v} * options_.dilation * input.block();
  };
  const int unit = on_tiles_ ? element_size(options_.format.precision) : 1;  // bytes there
  ArenaVector<std::ptrdiff_t> taps(arena, static_cast<std::size_t>(groups_.front().taps()));
  for (int b = 0; b < input.blocks() / options_.groups; ++b) {
    for (int u = 0; u < kernel_height_; ++u) {
      for (int v = 0; v < columns; ++v) {
        taps.push_back(unit * (b * input.block_stride() + u * options_.dilation * input.row_stride() +
                               column_offset(v)));
      }
    }
  }
  ConvolutionCall call;
  call.taps = taps.data();
  call.stride = options_.stride;
  call.padding = options_.padding;
  call.activation = options_.activation;
  call.slope = options_.slope;
  call.input = &input;
  call.residual = residual;
  call.output = &output;
  if (on_tiles_) {
    TileConvolution convolution{call};
    convolution.weights = &groups_.front();
    convolve_on_tiles(convolution, arena);
    return;
  }
  const bool as_it_is = groups_.front().format().precision == Precision::f32;
  DirectConvolution convolution{call};
  convolution.groups = groups_;
  convolution.values = reinterpret_cast<const std::byte*>(as_it_is ? input.values() : converted.data());
  const bool one_pixel = output.height() == 1 && output.width() == 1 && output.border() == 0;
  if (one_pixel && options_.groups == 1) {
    convolve_images(convolution);
  } else {
    convolve_pixels(convolution);
  }
}

void Conv2d::over_rows(const FeatureMap& input, const FeatureMap* residual, FeatureMap& output) const {
  parallel_for({output.images(), output.blocks(), output.height()}, 4, [&](int n, int b, int y) {
    narrow_.row(input, options_.stride, options_.padding, options_.dilation, n, b, y, output);
    float* out = output.pixel(n, b, y, 0);
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(output.width()) * kBlock;
    if (residual != nullptr) {
      const float* r = residual->pixel(n, b, y, 0);
      for (std::ptrdiff_t i = 0; i < count; ++i) out[i] += r[i];
    }
    activate(out, count, options_.activation, options_.slope);
  });
}

}  // namespace penumbra::nn
