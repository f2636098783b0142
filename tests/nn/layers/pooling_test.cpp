// Pooling and the folding of batch norm.
#include "nn/layers/pooling.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/batch_norm.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;
using test::random_vector;

TEST(MaxPool, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(1);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    PoolOptions options;
    options.kernel = pick(random, 1, 4);
    options.stride = pick(random, 1, 3);
    options.padding = pick(random, 0, options.kernel / 2);
    const Tensor x = random_tensor({pick(random, 1, 2), pick(random, 1, 40),
                                    options.kernel + pick(random, 0, 9), options.kernel + pick(random, 0, 9)},
                                   trial);
    Arena arena;
    expect_close(to_tensor(max_pool(to_feature_map(x, arena), options, arena, pick(random, 0, 1))),
                 reference::max_pool(x, options), 0.0F);
  }
}

TEST(MaxPool, NegativeValuesAtTheEdgeSurviveThePadding) {
  Tensor x({1, 1, 1, 1});
  x.values[0] = -5.0F;
  Arena arena;
  EXPECT_EQ(to_tensor(max_pool(to_feature_map(x, arena, 1), {3, 2, 1}, arena)).values[0], -5.0F);
}

TEST(MaxPool, WindowsLargerThanTheMapAreInputErrors) {
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 4, 2, 2}, 1), arena);
  EXPECT_THROW(max_pool(map, {3, 1, 0}, arena), InputError);
  EXPECT_THROW(max_pool(map, {2, 0, 0}, arena), InputError);
  EXPECT_THROW(max_pool(map, {2, 1, 2}, arena), InputError);
  EXPECT_THROW(avg_pool(map, {3, 1, 0}, true, arena), InputError);
  EXPECT_THROW(adaptive_avg_pool(map, 0, 1, arena), InputError);
}

TEST(Subsample, TakesEverySecondPixel) {
  const Tensor x = random_tensor({1, 3, 5, 4}, 2);
  Arena arena;
  const Tensor y = to_tensor(subsample(to_feature_map(x, arena), 2, arena));
  ASSERT_EQ(y.shape, (Shape{1, 3, 3, 2}));
  EXPECT_EQ(y.at(0, 2, 2, 1), x.at(0, 2, 4, 2));
}

TEST(AvgPool, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(5);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    PoolOptions options;
    options.kernel = pick(random, 1, 5);
    options.stride = pick(random, 1, 3);
    options.padding = pick(random, 0, options.kernel / 2);
    const int smallest = std::max(options.kernel - 2 * options.padding, 1);
    const Tensor x = random_tensor({pick(random, 0, 2), pick(random, 1, 40), smallest + pick(random, 0, 9),
                                    smallest + pick(random, 0, 9)},
                                   trial);
    for (const bool count_padding : {false, true}) {
      Arena arena;
      expect_close(to_tensor(avg_pool(to_feature_map(x, arena), options, count_padding, arena, 1)),
                   reference::avg_pool(x, options, count_padding));
    }
  }
}

TEST(AdaptiveAndGlobalPools, AgreeWithTheReferenceOnRandomShapes) {
  std::mt19937 random(6);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Tensor x = random_tensor(
        {pick(random, 0, 2), pick(random, 1, 40), pick(random, 1, 20), pick(random, 1, 20)}, trial);
    const int height = pick(random, 1, 24), width = pick(random, 1, 24);
    Arena arena;
    const FeatureMap map = to_feature_map(x, arena, pick(random, 0, 1));
    expect_close(to_tensor(adaptive_avg_pool(map, height, width, arena)),
                 reference::adaptive_avg_pool(x, height, width));
    expect_close(to_tensor(adaptive_max_pool(map, height, width, arena)),
                 reference::adaptive_max_pool(x, height, width), 0.0F);
    expect_close(to_tensor(global_avg_pool(map, arena)), reference::global_avg_pool(x));
    expect_close(to_tensor(global_max_pool(map, arena)), reference::global_max_pool(x), 0.0F);
  }
}

TEST(AdaptiveAvgPool, OfTheMapsOwnSizeIsTheMap) {
  const Tensor x = random_tensor({1, 17, 5, 7}, 3);
  Arena arena;
  expect_close(to_tensor(adaptive_avg_pool(to_feature_map(x, arena), 5, 7, arena)), x, 0.0F);
}

TEST(BatchNormFolding, AgreesWithNormalisingAfterTheConvolution) {
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const int outputs = 5 + static_cast<int>(trial);
    const Tensor x = random_tensor({1, 6, 4, 5}, trial),
                 weight = random_tensor({outputs, 6, 3, 3}, 100 + trial);
    BatchNorm norm{random_vector(outputs, 1), random_vector(outputs, 2), random_vector(outputs, 3),
                   random_vector(outputs, 4), trial % 2 == 0 ? 1e-5F : 0.0F};
    for (float& variance : norm.variance) variance = std::abs(variance) + 0.01F;
    const FoldedConvolution folded = fold_batch_norm(weight, norm);
    expect_close(reference::conv2d(x, folded.weight, folded.bias, {}),
                 reference::batch_norm(reference::conv2d(x, weight, {}, {}), norm));
  }
}

}  // namespace
}  // namespace penumbra::nn
