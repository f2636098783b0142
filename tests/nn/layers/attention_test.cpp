// Attention of every kind, and ASFF.
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/asff.h"
#include "nn/layers/coordinate_attention.h"
#include "nn/layers/mixed_attention.h"
#include "nn/layers/reference/reference.h"
#include "nn/layers/self_attention.h"
#include "tests/support/image_cases.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;
using test::random_vector;

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
    ChannelAttention(reduce, expand).apply(map, arena);
    expect_close(to_tensor(map), reference::channel_attention(x, reduce, expand));
  }
}

TEST(MixedAttention, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const int channels = pick(random, 1, 40), hidden = pick(random, 1, 4);
    const Tensor x =
        random_tensor({pick(random, 0, 2), channels, pick(random, 1, 9), pick(random, 1, 9)}, trial);
    const Tensor spatial = random_tensor({1, 2, 7, 7}, 100 + trial);
    const Tensor reduce = random_tensor({hidden, channels}, 200 + trial);
    const Tensor expand = random_tensor({channels, hidden}, 300 + trial);
    Arena arena;
    FeatureMap map = to_feature_map(x, arena);
    MixedAttention(SpatialAttention(spatial), ChannelAttention(reduce, expand)).apply(map, arena);
    expect_close(to_tensor(map), reference::mixed_attention(x, spatial, reduce, expand));
  }
}

TEST(CoordinateAttention, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(4);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int channels = pick(random, 1, 40), hidden = pick(random, 1, 20);
    const Tensor x =
        random_tensor({pick(random, 0, 3), channels, pick(random, 1, 12), pick(random, 1, 12)}, trial);
    const CoordinateAttentionWeights weights{
        random_tensor({hidden, channels, 1, 1}, 100 + trial), random_vector(hidden, 200 + trial),
        random_tensor({channels, hidden, 1, 1}, 300 + trial), random_vector(channels, 400 + trial),
        random_tensor({channels, hidden, 1, 1}, 500 + trial), {}};
    Arena arena;
    FeatureMap map = to_feature_map(x, arena, pick(random, 0, 1));
    const CoordinateAttention attention(weights);
    attention.apply(map, arena);
    const Tensor expected = reference::coordinate_attention(x, weights);
    expect_close(to_tensor(map), expected);

    const Tensor shortcut = random_tensor(x.shape, 600 + trial);
    const FeatureMap shortcut_map = to_feature_map(shortcut, arena, pick(random, 0, 1));
    map = to_feature_map(x, arena);
    attention.apply(map, arena, &shortcut_map);
    expect_close(to_tensor(map), reference::add(shortcut, expected));
  }
}

class AsffTest : public test::EveryIsa {};

TEST_P(AsffTest, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(5);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int height = 4 * pick(random, 1, 4), width = 4 * pick(random, 1, 4);
    const Shape shape{pick(random, 0, 2), pick(random, 1, 40), height, width};
    const int count = pick(random, 1, 4);
    Arena arena;
    std::vector<Tensor> levels, weights;
    std::vector<FeatureMap> maps;
    for (int k = 0; k < count; ++k) {
      const std::uint32_t seed = 10 * trial + static_cast<std::uint32_t>(k);
      const int factor = k == 0 ? 1 : 1 << pick(random, 0, 2);  // some are coarser
      const Tensor level = random_tensor({shape[0], shape[1], height / factor, width / factor}, seed);
      levels.push_back(reference::upsample_nearest(level, height, width));
      weights.push_back(random_tensor({1, shape[1], 1, 1}, 1000 + seed));
      maps.push_back(to_feature_map(level, arena, pick(random, 0, 1)));
    }
    std::vector<const FeatureMap*> pointers;
    for (const FeatureMap& map : maps) pointers.push_back(&map);
    const std::vector<float> bias = trial % 2 == 0 ? random_vector(count, trial) : std::vector<float>{};
    expect_close(to_tensor(Asff(weights, bias)(pointers, arena, pick(random, 0, 1))),
                 reference::asff(levels, weights, bias));
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, AsffTest, test::every_isa(), test::isa_name);

class SelfAttentionTest : public test::EveryIsa {};

TEST_P(SelfAttentionTest, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(6);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int channels = pick(random, 1, 40), hidden = pick(random, 1, 20);
    const int largest = trial < 5 ? 32 : 12;
    const Tensor x = random_tensor(
        {pick(random, 0, 2), channels, pick(random, 1, largest), pick(random, 1, largest)}, trial);
    SelfAttentionWeights weights;
    weights.f = random_tensor({hidden, channels, 1, 1}, 100 + trial);
    weights.g = random_tensor({hidden, channels, 1, 1}, 200 + trial);
    weights.h = random_tensor({channels, channels, 1, 1}, 300 + trial);
    if (trial % 2 == 0) {
      weights.f_bias = random_vector(hidden, 400 + trial);
      weights.g_bias = random_vector(hidden, 500 + trial);
      weights.h_bias = random_vector(channels, 600 + trial);
    }
    weights.gamma = 0.7F;
    Arena arena;
    FeatureMap map = to_feature_map(x, arena, pick(random, 0, 1));
    SelfAttention(weights).apply(map, arena);
    expect_close(to_tensor(map), reference::self_attention(x, weights));
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, SelfAttentionTest, test::every_isa(), test::isa_name);

TEST(SelfAttention, WithGammaZeroIsTheIdentity) {
  const Tensor x = random_tensor({1, 20, 5, 6}, 1);
  SelfAttentionWeights weights;
  weights.f = weights.g = random_tensor({2, 20, 1, 1}, 2);
  weights.h = random_tensor({20, 20, 1, 1}, 3);
  Arena arena;
  FeatureMap map = to_feature_map(x, arena);
  SelfAttention(weights).apply(map, arena);
  expect_close(to_tensor(map), x, 0.0F);
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
  ChannelAttention(Tensor({2, 32}), Tensor({32, 2})).apply(map, arena);
  expect_close(to_tensor(map), half, 0.0F);
}

TEST(Attention, WrongShapesAreInputErrors) {
  EXPECT_THROW(SpatialAttention(random_tensor({1, 2, 4, 4}, 1)), InputError);
  EXPECT_THROW(SpatialAttention(random_tensor({2, 2, 7, 7}, 1)), InputError);
  EXPECT_THROW(ChannelAttention(random_tensor({2, 32}, 1), random_tensor({32, 3}, 1)), InputError);
  Arena arena;
  FeatureMap map = to_feature_map(random_tensor({1, 16, 2, 2}, 1), arena);
  EXPECT_THROW(ChannelAttention(Tensor({2, 32}), Tensor({32, 2})).apply(map, arena), InputError);
  EXPECT_THROW(CoordinateAttention(CoordinateAttentionWeights{}), InputError);
  EXPECT_THROW(SelfAttention(SelfAttentionWeights{}), InputError);
  const std::vector<Tensor> two{Tensor({1, 16, 1, 1}), Tensor({1, 16, 1, 1})};
  const FeatureMap other = to_feature_map(random_tensor({1, 16, 2, 3}, 1), arena);
  const FeatureMap* levels[] = {&map, &other};
  EXPECT_THROW(Asff(two, {})(levels, arena), InputError);
  EXPECT_THROW(Asff(two, {})(std::span(levels).first(1), arena), InputError);
  EXPECT_THROW(Asff(two, {1.0F}), InputError);
  EXPECT_THROW(Asff({}, {}), InputError);
}

}  // namespace
}  // namespace penumbra::nn
