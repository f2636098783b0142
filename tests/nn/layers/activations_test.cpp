#include "nn/layers/activations.h"

#include <gtest/gtest.h>

#include <limits>

#include "nn/layers/conv2d.h"
#include "nn/layers/reference/reference.h"
#include "nn/simd/exponential.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;

constexpr Activation kAll[] = {Activation::none,      Activation::relu,    Activation::leaky_relu,
                               Activation::silu,      Activation::sigmoid, Activation::hard_sigmoid,
                               Activation::hard_swish};

// Values in [-scale, scale), 1x1 maps and zero images among the shapes.
Tensor random_map(std::mt19937& random, std::uint32_t seed, float scale) {
  const int side = pick(random, 0, 5) == 0 ? 1 : 12;
  Tensor x = random_tensor(
      {pick(random, 0, 3), pick(random, 1, 40), pick(random, 1, side), pick(random, 1, side)}, seed);
  for (float& value : x.values) value *= scale;
  return x;
}

TEST(Activations, AgreeWithTheReferenceOnRandomShapesAndKeepTheBorderZero) {
  std::mt19937 random(1);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Tensor x = random_map(random, trial, 10.0F);
    for (const Activation activation : kAll) {
      Arena arena;
      FeatureMap map = to_feature_map(x, arena, 1);
      activate(map, activation, 0.1F);
      expect_close(to_tensor(map), reference::activate(x, activation, 0.1F));
      if (map.images() > 0) {
        EXPECT_EQ(map.pixel(0, 0, -1, 0)[0], 0.0F);
      }
    }
  }
}

TEST(Activations, LargeValuesSaturateAndNotANumberStays) {
  for (const Activation activation : kAll) {
    float values[] = {1e30F, -1e30F, std::nanf("")};
    activate(values, 3, activation);
    EXPECT_TRUE(std::isfinite(values[0]));
    EXPECT_TRUE(std::isfinite(values[1]));
    EXPECT_TRUE(std::isnan(values[2]));
  }
  float values[] = {200.0F, -200.0F};
  activate(values, 2, Activation::sigmoid);
  EXPECT_EQ(values[0], 1.0F);
  EXPECT_NEAR(values[1], 0.0F, 1e-37F);
}

TEST(Activations, TheExponentialIsExactToTheLastBits) {
  double worst = 0.0;
  for (float x = -87.0F; x <= 88.0F; x += 0.0037F) {
    const double expected = std::exp(static_cast<double>(x));
    worst = std::max(worst, std::abs(exponential(x) - expected) / expected);
  }
  EXPECT_LT(worst, 2e-7);
  EXPECT_EQ(exponential(0.0F), 1.0F);
  EXPECT_TRUE(std::isfinite(exponential(std::numeric_limits<float>::infinity())));
}

TEST(Activations, FusedIntoAConvolutionTheyGiveTheSame) {
  std::mt19937 random(2);
  const Isa before = current_isa();
  for (const Isa isa : kKernelIsas) {
    if (!is_supported(isa)) continue;
    use_isa(isa);
    for (std::uint32_t trial = 0; trial < 50; ++trial) {
      const Tensor x = random_tensor(
          {pick(random, 1, 2), pick(random, 1, 20), pick(random, 1, 9), pick(random, 1, 30)}, trial);
      const Tensor weight = random_tensor({pick(random, 1, 70), x.extent(1), 1, 1}, 100 + trial);
      Conv2dOptions options;
      options.activation = kAll[trial % std::size(kAll)];
      options.slope = 0.2F;
      Arena arena;
      const FeatureMap y = Conv2d(weight, {}, options)(to_feature_map(x, arena), arena, pick(random, 0, 1));
      expect_close(to_tensor(y), reference::conv2d(x, weight, {}, options));
    }
  }
  use_isa(before);
}

TEST(SoftmaxChannels, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Tensor x = random_map(random, trial, trial % 2 == 0 ? 5.0F : 100.0F);
    Arena arena;
    FeatureMap map = to_feature_map(x, arena, 1);
    softmax_channels(map);
    expect_close(to_tensor(map), reference::softmax_channels(x));
  }
}

}  // namespace
}  // namespace penumbra::nn
