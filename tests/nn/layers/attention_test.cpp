#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/channel_attention.h"
#include "nn/layers/reference/reference.h"
#include "nn/layers/spatial_attention.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;

TEST(SpatialAttention, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(1);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Tensor x = random_tensor(
        {pick(random, 1, 2), pick(random, 1, 40), pick(random, 1, 12), pick(random, 1, 12)}, trial);
    const int kernel = 2 * pick(random, 0, 3) + 1;
    const Tensor weight = random_tensor({1, 2, kernel, kernel}, 100 + trial);
    Arena arena;
    FeatureMap map = to_feature_map(x, arena, pick(random, 0, 1));
    SpatialAttention(weight).apply(map, arena);
    expect_close(to_tensor(map), reference::spatial_attention(x, weight));
  }
}

TEST(ChannelAttention, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(2);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const int channels = pick(random, 1, 70), hidden = pick(random, 1, 8);
    const Tensor x =
        random_tensor({pick(random, 1, 2), channels, pick(random, 1, 12), pick(random, 1, 12)}, trial);
    const Tensor reduce = random_tensor({hidden, channels}, 100 + trial);
    const Tensor expand = random_tensor({channels, hidden}, 200 + trial);
    Arena arena;
    FeatureMap map = to_feature_map(x, arena, 1);
    ChannelAttention(reduce, expand).apply(map);
    expect_close(to_tensor(map), reference::channel_attention(x, reduce, expand));
  }
}

TEST(Attention, ZeroWeightsHalveTheMap) {
  // sigmoid(0) = 1/2 in both.
  const Tensor x = random_tensor({1, 32, 4, 4}, 1);
  Tensor half = x;
  for (float& value : half.values) value *= 0.5F;
  Arena arena;
  FeatureMap map = to_feature_map(x, arena);
  SpatialAttention(Tensor({1, 2, 7, 7})).apply(map, arena);
  expect_close(to_tensor(map), half, 0.0F);
  map = to_feature_map(x, arena);
  ChannelAttention(Tensor({2, 32}), Tensor({32, 2})).apply(map);
  expect_close(to_tensor(map), half, 0.0F);
}

TEST(Attention, WrongShapesAreInputErrors) {
  EXPECT_THROW(SpatialAttention(random_tensor({1, 2, 4, 4}, 1)), InputError);
  EXPECT_THROW(SpatialAttention(random_tensor({2, 2, 7, 7}, 1)), InputError);
  EXPECT_THROW(ChannelAttention(random_tensor({2, 32}, 1), random_tensor({32, 3}, 1)), InputError);
  Arena arena;
  FeatureMap map = to_feature_map(random_tensor({1, 16, 2, 2}, 1), arena);
  EXPECT_THROW(ChannelAttention(Tensor({2, 32}), Tensor({32, 2})).apply(map), InputError);
}

}  // namespace
}  // namespace penumbra::nn
