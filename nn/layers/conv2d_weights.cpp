// How conv2d.h's layers are set up: which method they take, and their weights in its order.
#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/base/half.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/narrow_maps.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

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
  if (tile_unit() != nullptr && groups > 1) options_.format.precision = Precision::f32;
  // 8 bits would be too few for an image.
  const bool image = input_block == kImageBlock;
  if (image && options_.format.precision == Precision::int8) options_.format.precision = Precision::bf16;
  if (image && input_channels_ > kImageBlock) options_.format.precision = Precision::f32;
  on_tiles_ = tile_unit() != nullptr && options_.format.precision != Precision::f32;
  if (image && !on_tiles_) options_.format.precision = Precision::f32;
  if (groups > 1 && (group_inputs % kBlock != 0 || group_outputs % kBlock != 0)) {
    narrow_ = NarrowGroups(weight, bias, groups);
    return;
  }
  if (image) {
    pack_image_weights(weight, bias);
    return;
  }
  const bool three_by_three =
      kernel_height_ == 3 && kernel_width_ == 3 && options.stride == 1 && options.dilation == 1;
  if (options.winograd && !on_tiles_ && three_by_three && groups == 1 &&
      winograd_pays(input_channels_, outputs_)) {
    // 8 bits would be too few for the sums that Winograd multiplies.
    const bool rough = options.format.precision != Precision::f32 && is_supported(Precision::bf16) &&
                       bf16_arithmetic() != Bf16Arithmetic::f32;
    winograd_ = Winograd(weight, bias, rough ? Precision::bf16 : Precision::f32);
    return;
  }
  pack_weights(weight, bias);
}

int Conv2d::tap_depth() const {
  if (on_tiles_) return line_channels(options_.format.precision);
  return input_block_ == kImageBlock ? kernel_width_ * kImageBlock : kBlock;
}

// The pixels of a kernel row lie side by side: one tap a row, of K_w * 4 channels.
void Conv2d::pack_image_weights(const Tensor& weight, const std::vector<float>& bias) {
  if (options_.dilation != 1) {
    throw InputError("conv2d over images", "dilation 1", fmt::format("{}", options_.dilation));
  }
  if (on_tiles_) {
    pack_split_weights(weight, bias);
    return;
  }
  const int taps = ceil_div(input_channels_, kImageBlock) * kernel_height_,
            depth = kernel_width_ * kImageBlock;
  const std::ptrdiff_t positions = std::ptrdiff_t{kernel_height_} * kernel_width_;
  WeightSource source{weight.values.data(), input_channels_ * positions, {}};
  for (int tap = 0; tap < taps; ++tap) {
    for (int c = 0; c < depth; ++c) {
      const int channel = tap / kernel_height_ * kImageBlock + c % kImageBlock;
      const int position = tap % kernel_height_ * kernel_width_ + c / kImageBlock;
      source.offsets.push_back(channel < input_channels_ ? channel * positions + position
                                                         : WeightSource::kNone);
    }
  }
  groups_.emplace_back(outputs_, taps, depth, source, bias);
}

// Image and weights are sums of two bf16: x w = x_h w_h + x_r w_h + x_h w_r, and what is left out is below
// the 16th bit. A kernel row fills some lines, whose last weights are 0; each line is read twice, for both
// parts of the weights.
void Conv2d::pack_split_weights(const Tensor& weight, const std::vector<float>& bias) {
  const int depth = tap_depth(), lines = split_row_lines(), taps = kernel_height_ * lines * 2;
  const std::ptrdiff_t positions = std::ptrdiff_t{kernel_height_} * kernel_width_;
  const std::ptrdiff_t count = input_channels_ * positions;  // of an output channel
  // Each output channel's weights, and behind them what bf16 leaves of them.
  std::vector<float> parts(2 * weight.values.size());
  for (std::size_t i = 0; i < weight.values.size(); ++i) {
    const std::ptrdiff_t output = static_cast<std::ptrdiff_t>(i) / count;
    float* const part = parts.data() + static_cast<std::ptrdiff_t>(i) + output * count;
    part[0] = weight.values[i];
    part[count] = weight.values[i] - bf16_to_f32(f32_to_bf16(weight.values[i]));
  }
  WeightSource source{parts.data(), 2 * count, {}};
  for (int tap = 0; tap < taps; ++tap) {
    for (int c = 0; c < depth; ++c) {
      const int row = tap / (2 * lines), part = tap % 2, lane = tap / 2 % lines * depth + c;
      const int v = lane / kSplitImageBlock, channel = lane % kImageBlock;
      const bool remainder = lane % kSplitImageBlock >= kImageBlock;
      const bool none = channel >= input_channels_ || v >= kernel_width_ || (part == 1 && remainder);
      source.offsets.push_back(none ? WeightSource::kNone
                                    : part * count + channel * positions + row * kernel_width_ + v);
    }
  }
  groups_.emplace_back(outputs_, taps, depth, source, bias, options_.format);
}

int Conv2d::split_row_lines() const { return ceil_div(kernel_width_ * kSplitImageBlock, tap_depth()); }

void Conv2d::pack_weights(const Tensor& weight, const std::vector<float>& bias) {
  const int group_outputs = outputs_ / options_.groups, group_inputs = input_channels_ / options_.groups;
  const int positions = kernel_height_ * kernel_width_, depth = tap_depth();
  const int taps = ceil_div(group_inputs, depth) * positions;
  WeightSource source{nullptr, std::ptrdiff_t{group_inputs} * positions, {}};
  source.offsets.reserve(static_cast<std::size_t>(taps) * static_cast<std::size_t>(depth));
  for (int tap = 0; tap < taps; ++tap) {
    for (int c = 0; c < depth; ++c) {
      const int channel = tap / positions * depth + c;
      source.offsets.push_back(channel < group_inputs ? std::ptrdiff_t{channel} * positions + tap % positions
                                                      : WeightSource::kNone);
    }
  }
  for (int g = 0; g < options_.groups; ++g) {
    const int first = g * group_outputs;
    source.values = weight.values.data() + first * source.output_stride;
    groups_.emplace_back(
        group_outputs, taps, depth, source,
        bias.empty() ? bias : std::vector<float>(bias.begin() + first, bias.begin() + first + group_outputs),
        options_.format);
  }
}

Conv2d linear(Tensor weight, const std::vector<float>& bias, int channels, int height, int width,
              Activation activation, const NumberFormat& format) {
  const std::int64_t inputs = static_cast<std::int64_t>(channels) * height * width;
  if (weight.shape.size() != 2 || weight.extent(1) != inputs) {
    throw InputError("linear", fmt::format("a weight [O, {}]", inputs), to_string(weight.shape));
  }
  Conv2dOptions options;
  options.activation = activation;
  options.format = format;
  weight.shape = {weight.extent(0), channels, height, width};
  return {weight, bias, options};
}

}  // namespace penumbra::nn
