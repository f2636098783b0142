// Convolutions of bf16 and 8-bit numbers. Their products are exact, so they must agree with the reference as
// closely as f32 does, once its inputs and weights are rounded the same way.
#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "nn/base/error.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/narrow_maps.h"
#include "nn/layers/reference/reference.h"
#include "nn/simd/tile_unit.h"
#include "tests/support/rounded_numbers.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;
using test::random_vector;
using test::rounded_input;
using test::rounded_weight;

class LowPrecisionTest : public ::testing::TestWithParam<Precision> {
 protected:
  // The register tile's kernels, also on a machine with a tile unit.
  void SetUp() override {
    if (current_isa() == Isa::amx) use_isa(Isa::avx512);
    if (!is_supported(GetParam())) GTEST_SKIP() << "no " << to_string(GetParam()) << " here";
    if (!is_supported(Precision::bf16)) return;  // 8-bit numbers alone: Winograd's are f32
    before_arithmetic_ = bf16_arithmetic();
    use_bf16_arithmetic(Bf16Arithmetic::dot_products);
  }
  void TearDown() override {
    if (before_arithmetic_) use_bf16_arithmetic(*before_arithmetic_);
    use_isa(before_);
  }

 private:
  Isa before_ = current_isa();
  std::optional<Bf16Arithmetic> before_arithmetic_;
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
    const Tensor rounded_x = rounded_input(x, numbers_of(options.format));
    const Tensor rounded_w = rounded_weight(weight, GetParam());
    Tensor expected = reference::conv2d(rounded_x, rounded_w, bias, options);
    const Tensor residual = random_tensor(expected.shape, 300 + trial);
    expected = reference::conv2d(rounded_x, rounded_w, bias, options, &residual);

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
  Tensor flat = rounded_input(x, numbers_of(format));
  flat.shape = {130, 48 * 25};
  Tensor expected = reference::linear(flat, rounded_weight(weight, GetParam()), {}, Activation::relu);
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

// Widening is exact, so maps of bf16 give the same sums, which are then rounded once.
TEST_P(LowPrecisionTest, WinogradReadsAndWritesBf16) {
  if (line_kernels() == nullptr) GTEST_SKIP() << "no maps of bf16 here";
  const Numbers bf16{Precision::bf16, {}};
  std::mt19937 random(4);
  for (std::uint32_t trial = 0; trial < 12; ++trial) {
    // Narrow maps, and some wider than the tiles that are widened at a time.
    const int height = pick(random, 1, 12), width = pick(random, 1, 90), images = pick(random, 1, 2);
    const int channels = pick(random, 32, 100), outputs = trial % 4 == 0 ? 48 : 32 * pick(random, 1, 3);
    Conv2dOptions options;
    options.padding = 1;
    options.format = {GetParam(), {1.0F / 127, 127}, nullptr};
    options.activation = trial % 3 == 0 ? Activation::silu : Activation::relu;
    const Conv2d conv(random_tensor({outputs, channels, 3, 3}, trial), random_vector(outputs, trial),
                      options);
    ASSERT_STREQ(conv.algorithm(), "winograd");
    EXPECT_EQ(conv.input_numbers(), bf16);
    Arena arena;
    const FeatureMap narrow = in_numbers(
        to_feature_map(random_tensor({images, channels, height, width}, 50 + trial), arena, 1), bf16, arena);
    const FeatureMap wide = in_numbers(narrow, {}, arena);
    const FeatureMap residual = in_numbers(
        to_feature_map(random_tensor({images, outputs, height, width}, trial), arena), bf16, arena);
    const FeatureMap wide_residual = in_numbers(residual, {}, arena);
    const Tensor expected = to_tensor(conv(wide, arena, 0, &wide_residual));
    EXPECT_EQ(to_tensor(conv(narrow, arena, 1, &residual)).values, expected.values);
    // Half a line, or an activation that is not part of the pass, is f32 whatever is asked for.
    const FeatureMap rounded = conv(wide, arena, 1, &residual, bf16);
    const bool stays_wide = outputs == 48 || options.activation == Activation::silu;
    EXPECT_EQ(rounded.numbers(), stays_wide ? Numbers{} : bf16);
    if (stays_wide) continue;
    EXPECT_EQ(
        to_tensor(in_numbers(rounded, {}, arena)).values,
        to_tensor(in_numbers(in_numbers(conv(narrow, arena, 0, &residual), bf16, arena), {}, arena)).values);
  }
}

TEST_P(LowPrecisionTest, DirectLayersReadBf16) {
  if (line_kernels() == nullptr) GTEST_SKIP() << "no maps of bf16 here";
  Conv2dOptions options;
  options.format = {GetParam(), {1.0F / 127, 127}, nullptr};
  const Conv2d conv(random_tensor({48, 70, 1, 1}, 1), {}, options);
  const Numbers bf16{Precision::bf16, {}};
  Arena arena;
  const FeatureMap narrow = in_numbers(to_feature_map(random_tensor({1, 70, 5, 9}, 2), arena), bf16, arena);
  const FeatureMap wide = in_numbers(narrow, {}, arena);
  EXPECT_EQ(to_tensor(conv(narrow, arena)).values, to_tensor(conv(wide, arena)).values);
  // A residual as well, also where nobody reads it afterwards, and where the output is laid out otherwise.
  FeatureMap residual = in_numbers(to_feature_map(random_tensor({1, 48, 5, 9}, 3), arena), bf16, arena);
  const FeatureMap wide_residual = in_numbers(residual, {}, arena);
  const std::vector<float> expected = to_tensor(conv(wide, arena, 0, &wide_residual)).values;
  EXPECT_EQ(to_tensor(conv(narrow, arena, 0, &residual)).values, expected);
  EXPECT_EQ(to_tensor(conv(narrow, arena, 1, &residual)).values, expected);
  EXPECT_EQ(to_tensor(conv.onto(std::move(residual), narrow, arena)).values, expected);
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
