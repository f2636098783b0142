#include "nn/layers/conv2d.h"

#include <gtest/gtest.h>

#include <utility>

#include "nn/base/error.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;
using test::random_vector;

// Every test runs with each instruction set that this machine has.
class Conv2dTest : public ::testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!is_supported(GetParam())) GTEST_SKIP() << "no " << to_string(GetParam()) << " here";
    before_ = current_isa();
    use_isa(GetParam());
  }
  void TearDown() override {
    if (is_supported(GetParam())) use_isa(before_);
  }

 private:
  Isa before_ = Isa::baseline;
};

TEST_P(Conv2dTest, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(7);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int images = pick(random, 1, 3), channels = pick(random, 1, 40), outputs = pick(random, 1, 70);
    const int kernel_h = pick(random, 1, 5), kernel_w = pick(random, 1, 5);
    Conv2dOptions options;
    options.stride = pick(random, 1, 3);
    options.dilation = pick(random, 1, 2);
    options.padding = pick(random, 0, 3);
    options.activation = pick(random, 0, 1) == 1 ? Activation::relu : Activation::none;
    const int smallest_h = std::max(options.dilation * (kernel_h - 1) + 1 - 2 * options.padding, 1);
    const int smallest_w = std::max(options.dilation * (kernel_w - 1) + 1 - 2 * options.padding, 1);
    const Tensor x = random_tensor(
        {images, channels, smallest_h + pick(random, 0, 12), smallest_w + pick(random, 0, 40)}, trial);
    const Tensor weight = random_tensor({outputs, channels, kernel_h, kernel_w}, 1000 + trial);
    const std::vector<float> bias =
        pick(random, 0, 3) == 0 ? std::vector<float>{} : random_vector(outputs, trial);

    Tensor expected = reference::conv2d(x, weight, bias, options);
    const bool with_residual = pick(random, 0, 1) == 1;
    const Tensor residual = random_tensor(expected.shape, 2000 + trial);
    if (with_residual) expected = reference::conv2d(x, weight, bias, options, &residual);

    Arena arena;
    const FeatureMap residual_map = to_feature_map(residual, arena, pick(random, 0, 1));
    const FeatureMap y =
        Conv2d(weight, bias, options)(to_feature_map(x, arena, pick(random, 0, 3)), arena, pick(random, 0, 2),
                                      with_residual ? &residual_map : nullptr);
    expect_close(to_tensor(y), expected);
  }
}

TEST_P(Conv2dTest, WinogradAgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(11);
  for (std::uint32_t trial = 0; trial < 40; ++trial) {
    Conv2dOptions options;
    options.padding = pick(random, 0, 2);
    options.activation = static_cast<Activation>(pick(random, 0, 6));
    const int channels = pick(random, 32, 100), outputs = pick(random, 32, 100);
    const Tensor x = random_tensor(
        {pick(random, 0, 3), channels, pick(random, 3, 14), pick(random, 3, trial % 8 == 0 ? 90 : 20)},
        trial);
    const Tensor weight = random_tensor({outputs, channels, 3, 3}, 1000 + trial);
    const std::vector<float> bias =
        pick(random, 0, 3) == 0 ? std::vector<float>{} : random_vector(outputs, trial);
    const Tensor residual = random_tensor(reference::conv2d(x, weight, bias, options).shape, 2000 + trial);
    const bool with_residual = pick(random, 0, 1) == 1;
    Arena arena;
    const FeatureMap residual_map = to_feature_map(residual, arena, pick(random, 0, 1));
    const Conv2d conv(weight, bias, options);
    ASSERT_STREQ(conv.algorithm(), "winograd");
    const FeatureMap y = conv(to_feature_map(x, arena, pick(random, 0, 3)), arena, pick(random, 0, 2),
                              with_residual ? &residual_map : nullptr);
    expect_close(to_tensor(y),
                 reference::conv2d(x, weight, bias, options, with_residual ? &residual : nullptr));
  }
}

// Maps so large that every thread has blocks of its own, and so deep that all threads share them.
TEST_P(Conv2dTest, WinogradAgreesWithTheDirectSumInEveryDivisionOfLabour) {
  for (const auto& [channels, size] : {std::pair(32, 150), std::pair(144, 40)}) {
    const Tensor x = random_tensor({1, channels, size, size}, 1);
    const Tensor weight = random_tensor({channels, channels, 3, 3}, 2);
    Conv2dOptions options;
    options.padding = 1;
    Arena arena;
    const FeatureMap map = to_feature_map(x, arena, 1);
    const Tensor winograd = to_tensor(Conv2d(weight, {}, options)(map, arena));
    options.winograd = false;
    const Conv2d direct(weight, {}, options);
    ASSERT_STREQ(direct.algorithm(), "direct");
    expect_close(winograd, to_tensor(direct(map, arena)));
  }
}

TEST_P(Conv2dTest, ASumOntoTheResidualHasTheSameBitsAndItsMemory) {
  struct Case {
    int channels, outputs, kernel, groups, size, border;
    Activation activation;
    bool in_place;
  };
  const Case cases[] = {{40, 70, 1, 1, 9, 0, Activation::relu, true},
                        {40, 70, 3, 1, 9, 0, Activation::silu, true},  // Winograd
                        {40, 70, 5, 1, 9, 0, Activation::silu, true},
                        {64, 64, 3, 2, 9, 0, Activation::relu, true},    // groups
                        {40, 70, 1, 1, 9, 1, Activation::relu, false},   // another border
                        {24, 24, 3, 24, 9, 0, Activation::relu, false},  // a channel at a time
                        {40, 70, 1, 1, 1, 0, Activation::relu, false}};  // over images
  for (const Case& c : cases) {
    Conv2dOptions options;
    options.padding = c.kernel / 2;
    options.groups = c.groups;
    options.activation = c.activation;
    const Conv2d conv(random_tensor({c.outputs, c.channels / c.groups, c.kernel, c.kernel}, 1),
                      random_vector(c.outputs, 2), options);
    Arena arena;
    const FeatureMap x = to_feature_map(random_tensor({3, c.channels, c.size, c.size}, 3), arena);
    FeatureMap residual = to_feature_map(random_tensor({3, c.outputs, c.size, c.size}, 4), arena);
    const Tensor expected = to_tensor(conv(x, arena, 0, &residual));
    const float* const memory = residual.values();
    const FeatureMap y = conv.onto(std::move(residual), with_border(x, arena, 0), arena, c.border);
    EXPECT_EQ(to_tensor(y).values, expected.values) << conv.algorithm();
    EXPECT_EQ(y.values() == memory, c.in_place) << conv.algorithm();
    EXPECT_EQ(y.border(), c.border);
  }
}

TEST_P(Conv2dTest, WeightsPreparedOnceServeSeveralMaps) {
  for (const bool winograd : {true, false}) {
    Conv2dOptions options;
    options.winograd = winograd;
    options.padding = 1;
    const Conv2d conv(random_tensor({40, 50, 3, 3}, 1), random_vector(40, 2), options);
    Arena arena;
    const ArenaBuffer prepared = conv.prepare(arena);
    for (const int size : {5, 9}) {
      const FeatureMap map = to_feature_map(random_tensor({1, 50, size, size + 3}, 3), arena, size % 2);
      EXPECT_EQ(to_tensor(conv(map, arena, prepared)).values, to_tensor(conv(map, arena)).values);
    }
  }
}

// G g G^T in f64, rounded once: the same bits on every instruction set.
TEST_P(Conv2dTest, WinogradsWeightsAreExact) {
  constexpr int kChannels = 16, kCount = 5;
  const Tensor kernels = random_tensor({kCount, 9, kChannels}, 7);
  std::vector<float> found(36 * kCount * kChannels);
  WinogradWeightArguments a;
  a.input = kernels.values.data();
  a.output = found.data();
  a.position_stride = kCount * kChannels;
  a.channels = kChannels;
  a.count = kCount;
  nn::kernels().winograd_weights(a);
  const double p[] = {0.0, kWinogradA, -kWinogradA, kWinogradB, -kWinogradB};
  double g[6][3] = {};
  for (int i = 0; i < 5; ++i) {
    double n = 1.0;
    for (int k = 0; k < 5; ++k) n *= k == i ? 1.0 : p[i] - p[k];
    for (int j = 0; j < 3; ++j) g[i][j] = (j == 0 ? 1.0 : j == 1 ? p[i] : p[i] * p[i]) / n;
  }
  g[5][2] = 1.0;
  for (int k = 0; k < kCount; ++k) {
    for (int o = 0; o < kChannels; ++o) {
      for (int position = 0; position < 36; ++position) {
        double sum = 0.0;
        for (int i = 0; i < 9; ++i) {
          sum += g[position / 6][i / 3] * g[position % 6][i % 3] *
                 static_cast<double>(kernels.values[static_cast<std::size_t>((k * 9 + i) * kChannels + o)]);
        }
        const float value = found[static_cast<std::size_t>((position * kCount + k) * kChannels + o)];
        ASSERT_NEAR(value, sum, 6e-8 * std::abs(sum) + 1e-12);
      }
    }
  }
}

TEST_P(Conv2dTest, GroupsAgreeWithTheReferenceOnRandomShapes) {
  std::mt19937 random(10);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    Conv2dOptions options;
    options.groups = pick(random, 2, 20);
    int group_inputs = pick(random, 1, 5), group_outputs = pick(random, 1, 5);
    if (trial % 3 == 0) group_inputs = group_outputs = 1;  // depthwise
    if (trial % 3 == 1) {                                  // whole blocks
      options.groups = pick(random, 2, 3);
      group_inputs = 16 * pick(random, 1, 2);
      group_outputs = 16 * pick(random, 1, 3);
    }
    const int channels = options.groups * group_inputs, outputs = options.groups * group_outputs;
    const int kernel = pick(random, 1, 4);
    options.stride = pick(random, 1, 3);
    options.dilation = pick(random, 1, 2);
    options.padding = pick(random, 0, 2);
    options.activation = static_cast<Activation>(pick(random, 0, 6));
    const int smallest = std::max(options.dilation * (kernel - 1) + 1 - 2 * options.padding, 1);
    const Tensor x = random_tensor(
        {pick(random, 0, 2), channels, smallest + pick(random, 0, 8), smallest + pick(random, 0, 20)}, trial);
    const Tensor weight = random_tensor({outputs, group_inputs, kernel, kernel}, 1000 + trial);
    const std::vector<float> bias =
        pick(random, 0, 3) == 0 ? std::vector<float>{} : random_vector(outputs, trial);
    const Tensor residual = random_tensor(reference::conv2d(x, weight, bias, options).shape, 2000 + trial);
    Arena arena;
    const FeatureMap residual_map = to_feature_map(residual, arena);
    const FeatureMap y = Conv2d(weight, bias, options)(to_feature_map(x, arena, pick(random, 0, 3)), arena,
                                                       pick(random, 0, 1), &residual_map);
    expect_close(to_tensor(y), reference::conv2d(x, weight, bias, options, &residual));
  }
}

TEST_P(Conv2dTest, ReadsImagesOfFourChannelPixels) {
  std::mt19937 random(8);
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const int channels = pick(random, 1, 4), kernel = 2 * pick(random, 0, 3) + 1;
    Conv2dOptions options;
    options.stride = pick(random, 1, 2);
    options.padding = kernel / 2;
    const Tensor x = random_tensor({1, channels, pick(random, 1, 20), pick(random, 1, 40)}, trial);
    const Tensor weight = random_tensor({pick(random, 1, 64), channels, kernel, kernel}, 100 + trial);
    Arena arena;
    const FeatureMap image = to_feature_map(x, arena, options.padding, kImageBlock);
    expect_close(to_tensor(Conv2d(weight, {}, options, kImageBlock)(image, arena)),
                 reference::conv2d(x, weight, {}, options));
  }
}

TEST_P(Conv2dTest, FullyConnectedLayersAgreeWithTheReference) {
  std::mt19937 random(9);
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const int images = pick(random, 1, 130), channels = pick(random, 1, 90), size = pick(random, 1, 7);
    const int outputs = pick(random, 1, 100);
    const Tensor x = random_tensor({images, channels, size, size}, trial);
    const Tensor weight = random_tensor({outputs, channels * size * size}, 100 + trial);
    const std::vector<float> bias = random_vector(outputs, 200 + trial);
    Arena arena;
    const FeatureMap y =
        linear(weight, bias, channels, size, size, Activation::relu)(to_feature_map(x, arena), arena);
    Tensor expected =
        reference::linear({{images, channels * size * size}, x.values}, weight, bias, Activation::relu);
    expected.shape = {images, outputs, 1, 1};
    expect_close(to_tensor(y), expected);
  }
}

TEST_P(Conv2dTest, ZeroImagesGiveZeroImages) {
  Arena arena;
  const FeatureMap none(arena, 0, 32, 7, 7, 0);
  EXPECT_EQ(linear(random_tensor({10, 32 * 49}, 1), {}, 32, 7, 7, Activation::none)(none, arena).images(), 0);
}

TEST_P(Conv2dTest, TheResultDoesNotDependOnPaddingByBorderOrByCopy) {
  const Tensor x = random_tensor({1, 32, 9, 30}, 1), weight = random_tensor({32, 32, 3, 3}, 2);
  Conv2dOptions options;
  options.padding = 1;
  const Conv2d conv(weight, {}, options);
  Arena arena;
  EXPECT_EQ(to_tensor(conv(to_feature_map(x, arena, 0), arena)).values,
            to_tensor(conv(to_feature_map(x, arena, 1), arena)).values);
}

TEST_P(Conv2dTest, NotANumberIsNotHiddenByRelu) {
  Tensor x({1, 16, 1, 1});
  x.values[3] = std::nanf("");
  Conv2dOptions options;
  options.activation = Activation::relu;
  Arena arena;
  const FeatureMap y = Conv2d(random_tensor({1, 16, 1, 1}, 1), {}, options)(to_feature_map(x, arena), arena);
  EXPECT_TRUE(std::isnan(y.pixel(0, 0, 0, 0)[0]));
}

INSTANTIATE_TEST_SUITE_P(EveryIsa, Conv2dTest, ::testing::ValuesIn(kKernelIsas),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(Conv2d, WrongShapesAreInputErrors) {
  Arena arena;
  EXPECT_THROW(Conv2d(random_tensor({8, 8}, 1), {}, {}), InputError);
  EXPECT_THROW(Conv2d(random_tensor({8, 8, 1, 1}, 1), random_vector(7, 1), {}), InputError);
  Conv2dOptions options;
  options.groups = 3;
  EXPECT_THROW(Conv2d(random_tensor({8, 8, 1, 1}, 1), {}, options), InputError);
  const Conv2d conv(random_tensor({8, 8, 3, 3}, 1), {}, {});
  EXPECT_THROW(conv(to_feature_map(random_tensor({1, 9, 5, 5}, 1), arena), arena), InputError);
  EXPECT_THROW(conv(to_feature_map(random_tensor({1, 8, 2, 5}, 1), arena), arena), InputError);
  EXPECT_THROW(linear(random_tensor({4, 10}, 1), {}, 3, 2, 2, Activation::none), InputError);
}

}  // namespace
}  // namespace penumbra::nn
