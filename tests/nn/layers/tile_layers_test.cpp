// Layers on a tile unit: all kernels, strides and sizes, narrow maps on either side. Products are exact, so
// they must agree with the reference as closely as f32 does, once its inputs and weights are rounded the same
// way. On the processor's own unit where there is one, else on the emulation alone.
#include <gtest/gtest.h>

#include <functional>

#include "nn/base/parallel.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/conv_transpose2d.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/rounded_numbers.h"
#include "tests/support/stored_maps.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::expect_same_bits;
using test::expect_stored;
using test::kAllNumbers;
using test::kBf16;
using test::kBytes;
using test::pick;
using test::random_tensor;
using test::random_vector;
using test::rounded_input;
using test::rounded_weight;

class TileLayersTest : public ::testing::TestWithParam<Precision> {
 protected:
  void SetUp() override { use_isa(Isa::amx_emulated); }
  void TearDown() override { use_isa(before_); }

  Numbers numbers() const { return GetParam() == Precision::bf16 ? kBf16 : kBytes; }
  NumberFormat format() const { return {numbers().precision, numbers().quantisation, nullptr}; }

  // Runs a layer that `make` builds on the emulation, and where there is a tile unit on that as well.
  FeatureMap run(const std::function<FeatureMap()>& make) const {
    if (!is_supported(Isa::amx)) return make();
    use_isa(Isa::amx);
    const FeatureMap real = make();
    use_isa(Isa::amx_emulated);
    FeatureMap emulated = make();
    expect_same_bits(emulated, real);
    return emulated;
  }

  Isa before_ = current_isa();
};

TEST_P(TileLayersTest, ConvolutionsAgreeWithTheReferenceOfRoundedNumbers) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    Conv2dOptions options;
    options.format = format();
    options.stride = pick(random, 1, 3);
    options.padding = pick(random, 0, 2);
    options.dilation = pick(random, 1, 2);
    const Activation activations[] = {Activation::none, Activation::relu, Activation::silu};
    options.activation = activations[trial % 3];
    const int channels = pick(random, 1, 80), outputs = pick(random, 1, 80);
    const int kernel_h = pick(random, 1, 3), kernel_w = pick(random, 1, 3);
    const int least_h = options.dilation * (kernel_h - 1) + 1,
              least_w = options.dilation * (kernel_w - 1) + 1;
    const Tensor x = random_tensor(
        {pick(random, 0, 2), channels, pick(random, least_h, 7), pick(random, least_w, 40)}, trial);
    const Tensor weight = random_tensor({outputs, channels, kernel_h, kernel_w}, 100 + trial);
    const std::vector<float> bias = random_vector(outputs, 200 + trial);
    const Tensor rounded_x = rounded_input(x, numbers()), rounded_w = rounded_weight(weight, GetParam());
    const Numbers residual_numbers = kAllNumbers[pick(random, 0, 2)],
                  output = kAllNumbers[pick(random, 0, 2)];
    const bool has_residual = trial % 2 == 0;
    const auto extent = [&](std::int64_t in, int kernel) {
      return (in + 2 * options.padding - options.dilation * (kernel - 1) - 1) / options.stride + 1;
    };
    const Tensor residual = rounded_input(
        random_tensor({x.extent(0), outputs, extent(x.extent(2), kernel_h), extent(x.extent(3), kernel_w)},
                      300 + trial),
        residual_numbers);
    const Tensor expected =
        reference::conv2d(rounded_x, rounded_w, bias, options, has_residual ? &residual : nullptr);

    Arena arena;
    FeatureMap input = to_feature_map(x, arena, pick(random, 0, 2));
    if (trial % 4 != 0) input = in_numbers(input, kAllNumbers[trial % 3], arena);
    // An input that was rounded otherwise before.
    if (input.numbers() != Numbers{} && input.numbers() != numbers()) input = to_feature_map(x, arena);
    FeatureMap added = to_feature_map(residual, arena);
    if (residual_numbers != Numbers{}) added = in_numbers(added, residual_numbers, arena);
    const int border = pick(random, 0, 1);
    const FeatureMap y = run([&] {
      const Conv2d conv(weight, bias, options);
      EXPECT_STREQ(conv.algorithm(), "tiles");
      EXPECT_EQ(conv.input_numbers(), numbers());
      return conv(input, arena, border, has_residual ? &added : nullptr, output);
    });
    expect_stored(y, expected, output, arena);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
}

TEST_P(TileLayersTest, DegenerateSizesWork) {
  for (const int channels : {1, 16, 31, 32, 33, 64, 65}) {
    for (const int outputs : {1, 16, 17, 32, 48, 65}) {
      const Tensor x = random_tensor({1, channels, 1, 1}, 1),
                   weight = random_tensor({outputs, channels, 3, 3}, 2);
      Conv2dOptions options;
      options.padding = 1;
      options.format = format();
      Arena arena;
      for (const Numbers& output : kAllNumbers) {
        const FeatureMap y = run([&] {
          return Conv2d(weight, {}, options)(to_feature_map(x, arena, 1), arena, 1, nullptr, output);
        });
        expect_stored(
            y,
            reference::conv2d(rounded_input(x, numbers()), rounded_weight(weight, GetParam()), {}, options),
            output, arena);
      }
    }
  }
}

TEST_P(TileLayersTest, NarrowMapsFromLayerToLayerAreTheSameAsConvertedOnes) {
  const Tensor x = random_tensor({2, 70, 9, 20}, 1);
  Conv2dOptions options;
  options.padding = 1;
  options.activation = Activation::relu;
  options.format = format();
  const Conv2d first(random_tensor({48, 70, 3, 3}, 2), {}, options),
      second(random_tensor({50, 48, 3, 3}, 3), {}, options);
  Arena arena;
  const FeatureMap input = to_feature_map(x, arena, 1);
  const FeatureMap narrow = second(first(input, arena, 1, nullptr, second.input_numbers()), arena);
  const FeatureMap wide = second(first(input, arena, 1), arena);
  expect_same_bits(narrow, wide);
}

TEST_P(TileLayersTest, FullyConnectedLayersAgreeWithTheReferenceOfRoundedNumbers) {
  for (const int images : {1, 16, 50, 130}) {
    const Tensor x = random_tensor({images, 48, 5, 5}, 1), weight = random_tensor({70, 48 * 25}, 2);
    Arena arena;
    const FeatureMap y = run([&] {
      return linear(weight, {}, 48, 5, 5, Activation::relu, format())(to_feature_map(x, arena), arena);
    });
    Tensor flat = rounded_input(x, numbers());
    flat.shape = {images, 48 * 25};
    Tensor expected = reference::linear(flat, rounded_weight(weight, GetParam()), {}, Activation::relu);
    expected.shape = {images, 70, 1, 1};
    expect_close(to_tensor(y), expected, 2e-5F);
  }
}

// Each phase of a transposed convolution is a layer of its own: a scale for each of its output channels.
Tensor rounded_transposed_weight(const Tensor& weight, Precision precision,
                                 const ConvTranspose2dOptions& options) {
  if (precision == Precision::bf16) return test::rounded_to_bf16(weight);
  const std::int64_t outputs = weight.extent(1), height = weight.extent(2), width = weight.extent(3);
  const auto phase = [&](std::int64_t u) {
    return (u * options.dilation - options.padding + 8 * options.stride) % options.stride;
  };
  return test::quantised_weight(weight, [&](std::int64_t i) {
    const std::int64_t o = i / (height * width) % outputs;
    return (o * options.stride + phase(i / width % height)) * options.stride + phase(i % width);
  });
}

TEST_P(TileLayersTest, TransposedConvolutionsAgreeWithTheReferenceOfRoundedNumbers) {
  std::mt19937 random(4);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int channels = pick(random, 1, 70), outputs = pick(random, 1, 70);
    const int kernel_h = pick(random, 1, 4), kernel_w = pick(random, 1, 4);
    ConvTranspose2dOptions options;
    options.stride = pick(random, 1, 3);
    options.dilation = pick(random, 1, 2);
    options.padding = pick(random, 0, 2);
    options.output_padding = pick(random, 0, std::max(options.stride, options.dilation) - 1);
    options.activation = trial % 3 == 0 ? Activation::silu : Activation::relu;
    options.format = format();
    const Tensor x =
        random_tensor({pick(random, 1, 2), channels, pick(random, 1, 7), pick(random, 1, 30)}, trial);
    const auto extent = [&](std::int64_t in, int kernel) {
      return (in - 1) * options.stride - 2 * options.padding + options.dilation * (kernel - 1) +
             options.output_padding + 1;
    };
    if (extent(x.extent(2), kernel_h) < 1 || extent(x.extent(3), kernel_w) < 1) continue;
    const Tensor weight = random_tensor({channels, outputs, kernel_h, kernel_w}, 1000 + trial);
    const std::vector<float> bias = random_vector(outputs, trial);
    const Numbers output = kAllNumbers[trial % 3];
    Arena arena;
    const FeatureMap y = run([&] {
      return ConvTranspose2d(weight, bias, options)(to_feature_map(x, arena, pick(random, 0, 2)), arena, 1,
                                                    output);
    });
    expect_stored(
        y,
        reference::conv_transpose2d(rounded_input(x, numbers()),
                                    rounded_transposed_weight(weight, GetParam(), options), bias, options),
        output, arena);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
}

// Images and their weights are split in two bf16 each, also where 8 bits are asked for: nearly f32.
TEST_P(TileLayersTest, StemsReadImages) {
  struct Stem {
    int kernel, stride, width;
  };
  for (const Stem& stem : {Stem{7, 2, 37}, Stem{6, 2, 16}, Stem{11, 4, 23}, Stem{3, 1, 1}}) {
    const Tensor x = random_tensor({1, 3, 12, stem.width}, 1);
    const Tensor weight = random_tensor({20, 3, stem.kernel, stem.kernel}, 2);
    Conv2dOptions options;
    options.stride = stem.stride;
    options.padding = stem.kernel / 2;
    options.format = format();
    Arena arena;
    const FeatureMap y = run([&] {
      const Conv2d conv(weight, {}, options, kImageBlock);
      EXPECT_STREQ(conv.algorithm(), "tiles");
      return conv(to_feature_map(x, arena, options.padding, kImageBlock), arena);
    });
    expect_close(to_tensor(y), reference::conv2d(x, weight, {}, options), 2e-5F);
  }
}

TEST_P(TileLayersTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Tensor x = random_tensor({1, 64, 33, 50}, 1), weight = random_tensor({96, 64, 3, 3}, 2);
  Conv2dOptions options;
  options.padding = 1;
  options.format = format();
  const Conv2d conv(weight, {}, options);
  Arena arena;
  const FeatureMap input = to_feature_map(x, arena, 1);
  const int threads = thread_count();
  set_thread_count(1);
  const FeatureMap one = conv(input, arena, 0, nullptr, numbers());
  set_thread_count(3);
  const FeatureMap three = conv(input, arena, 0, nullptr, numbers());
  set_thread_count(threads);
  expect_same_bits(one, three);
}

INSTANTIATE_TEST_SUITE_P(Every, TileLayersTest, ::testing::Values(Precision::bf16, Precision::int8),
                         [](const auto& info) { return std::string(to_string(info.param)); });

}  // namespace
}  // namespace penumbra::nn
