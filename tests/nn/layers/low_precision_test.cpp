// Convolutions of bf16 and 8-bit numbers. Their products are exact, so they must agree with the reference as
// closely as f32 does, once its inputs and weights are rounded the same way.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "nn/base/error.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;
using test::random_vector;

float as_bf16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>((bits + 0x7FFFU + ((bits >> 16) & 1U)) & 0xFFFF0000U);
}

Tensor rounded_to_bf16(Tensor tensor) {
  for (float& value : tensor.values) value = as_bf16(value);
  return tensor;
}

Tensor quantised_input(Tensor tensor, const Quantisation& q) {
  for (float& value : tensor.values) {
    const float whole = std::nearbyint(value / q.scale + static_cast<float>(q.zero));
    value = (std::min(std::max(whole, 0.0F), 255.0F) - static_cast<float>(q.zero)) * q.scale;
  }
  return tensor;
}

Tensor quantised_weight(Tensor weight) {
  const auto row = static_cast<std::size_t>(elements(weight.shape) / weight.shape.front());
  for (std::size_t first = 0; first < weight.values.size(); first += row) {
    float largest = 0.0F;
    for (std::size_t i = first; i < first + row; ++i) largest = std::max(largest, std::abs(weight.values[i]));
    for (std::size_t i = first; i < first + row; ++i) {
      weight.values[i] = std::nearbyint(weight.values[i] * (127.0F / largest)) * (largest / 127.0F);
    }
  }
  return weight;
}

class LowPrecisionTest : public ::testing::TestWithParam<Precision> {
 protected:
  void SetUp() override {
    if (!is_supported(GetParam())) GTEST_SKIP() << "no " << to_string(GetParam()) << " here";
  }
};

TEST_P(LowPrecisionTest, AgreesWithTheReferenceOfRoundedNumbers) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    Conv2dOptions options;
    options.format.precision = GetParam();
    options.winograd = false;
    // Inputs in -1..1; a power of two, so that the test rounds as the kernel does, which multiplies by 1 / s.
    options.format.input = {1.0F / 128, pick(random, 100, 140)};
    options.stride = pick(random, 1, 2);
    options.padding = pick(random, 0, 2);
    options.activation = pick(random, 0, 1) == 1 ? Activation::relu : Activation::none;
    options.groups = trial % 5 == 4 ? 2 : 1;
    const int channels = options.groups == 2 ? 32 : pick(random, 1, 70);
    const int outputs = options.groups == 2 ? 64 : pick(random, 1, 70), kernel = pick(random, 1, 3);
    const Tensor x =
        random_tensor({pick(random, 1, 2), channels, pick(random, 3, 12), pick(random, 3, 40)}, trial);
    const Tensor weight = random_tensor({outputs, channels / options.groups, kernel, kernel}, 100 + trial);
    const std::vector<float> bias = random_vector(outputs, 200 + trial);
    const bool bf16 = GetParam() == Precision::bf16;
    const Tensor rounded_x = bf16 ? rounded_to_bf16(x) : quantised_input(x, options.format.input);
    const Tensor rounded_weight = bf16 ? rounded_to_bf16(weight) : quantised_weight(weight);
    Tensor expected = reference::conv2d(rounded_x, rounded_weight, bias, options);
    const Tensor residual = random_tensor(expected.shape, 300 + trial);
    expected = reference::conv2d(rounded_x, rounded_weight, bias, options, &residual);

    Arena arena;
    const FeatureMap residual_map = to_feature_map(residual, arena);
    const Conv2d conv(weight, bias, options);
    EXPECT_STREQ(conv.algorithm(), "direct");
    const FeatureMap y = conv(to_feature_map(x, arena, pick(random, 0, 2)), arena, 0, &residual_map);
    expect_close(to_tensor(y), expected, 2e-5F);
  }
}

TEST_P(LowPrecisionTest, FullyConnectedLayersAgreeWithTheReferenceOfRoundedNumbers) {
  const Tensor x = random_tensor({130, 48, 5, 5}, 1), weight = random_tensor({70, 48 * 25}, 2);
  const NumberFormat format{GetParam(), {1.0F / 128, 128}, nullptr};
  Arena arena;
  const FeatureMap y =
      linear(weight, {}, 48, 5, 5, Activation::relu, format)(to_feature_map(x, arena), arena);
  const bool bf16 = GetParam() == Precision::bf16;
  Tensor flat = bf16 ? rounded_to_bf16(x) : quantised_input(x, format.input);
  flat.shape = {130, 48 * 25};
  Tensor expected = reference::linear(flat, bf16 ? rounded_to_bf16(weight) : quantised_weight(weight), {},
                                      Activation::relu);
  expected.shape = {130, 70, 1, 1};
  expect_close(to_tensor(y), expected, 2e-5F);
}

TEST_P(LowPrecisionTest, WinogradIsAsCloseAsItsRoundingAllows) {
  const Tensor x = random_tensor({1, 70, 17, 31}, 1), weight = random_tensor({80, 70, 3, 3}, 2);
  Conv2dOptions options;
  options.padding = 1;
  options.format = {GetParam(), {1.0F / 127, 127}, nullptr};
  const Conv2d conv(weight, {}, options);
  EXPECT_STREQ(conv.algorithm(), "winograd");
  Arena arena;
  // Its products are bf16 in both modes, and the transform back enlarges their rounding.
  expect_close(to_tensor(conv(to_feature_map(x, arena, 1), arena)), reference::conv2d(x, weight, {}, options),
               0.03F);
}

INSTANTIATE_TEST_SUITE_P(Every, LowPrecisionTest, ::testing::Values(Precision::bf16, Precision::int8),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(LowPrecision, NamesAreReadAndOtherNamesAreUsageErrors) {
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    EXPECT_EQ(precision_from_name(to_string(precision)), precision);
  }
  EXPECT_THROW(precision_from_name("fp16"), UsageError);
}

TEST(LowPrecision, NeedsTheWidestInstructionSet) {
  const Isa before = current_isa();
  use_isa(Isa::baseline);
  EXPECT_TRUE(is_supported(Precision::f32));
  EXPECT_FALSE(is_supported(Precision::int8));
  EXPECT_THROW(require(Precision::bf16), UsageError);
  use_isa(before);
}

}  // namespace
}  // namespace penumbra::nn
