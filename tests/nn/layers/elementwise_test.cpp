// concat, split, add and multiply.
#include "nn/layers/elementwise.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/concat.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;

TEST(Concat, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(1);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const int images = pick(random, 0, 3), height = pick(random, 1, 9), width = pick(random, 1, 9);
    Arena arena;
    std::vector<Tensor> parts;
    std::vector<FeatureMap> maps;
    for (int part = pick(random, 1, 4); part > 0; --part) {
      const int channels = pick(random, 0, 2) == 0 ? 16 * pick(random, 1, 3) : pick(random, 1, 40);
      parts.push_back(
          random_tensor({images, channels, height, width}, trial * 10 + static_cast<unsigned>(part)));
      maps.push_back(to_feature_map(parts.back(), arena, pick(random, 0, 2)));
    }
    std::vector<const FeatureMap*> pointers;
    for (const FeatureMap& map : maps) pointers.push_back(&map);
    const FeatureMap joined = concat(pointers, arena, pick(random, 0, 1));
    expect_close(to_tensor(joined), reference::concat(parts), 0.0F);

    std::vector<int> channels;
    for (const Tensor& part : parts) channels.push_back(static_cast<int>(part.extent(1)));
    const std::vector<FeatureMap> apart = split(joined, channels, arena, pick(random, 0, 1));
    ASSERT_EQ(apart.size(), parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) expect_close(to_tensor(apart[i]), parts[i], 0.0F);
  }
}

TEST(Concat, UnusedLanesOfTheLastBlockAreZero) {
  Arena arena;
  std::fill_n(arena.allocate(4096).data(), 4096, std::nanf(""));  // what the maps will find in their memory
  const FeatureMap x = to_feature_map(random_tensor({1, 9, 2, 2}, 1), arena);
  const FeatureMap* both[] = {&x, &x};
  const FeatureMap y = concat(both, arena);
  for (int lane = 2; lane < kBlock; ++lane) EXPECT_EQ(y.pixel(0, 1, 1, 1)[lane], 0.0F);
}

TEST(SliceChannels, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(2);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Tensor x = random_tensor(
        {pick(random, 1, 2), pick(random, 1, 70), pick(random, 1, 5), pick(random, 1, 5)}, trial);
    const int channels = static_cast<int>(x.extent(1)), first = pick(random, 0, channels - 1);
    const int count = pick(random, 1, channels - first);
    Arena arena;
    expect_close(to_tensor(slice_channels(to_feature_map(x, arena), first, count, arena)),
                 reference::slice_channels(x, first, count), 0.0F);
  }
}

TEST(Elementwise, AgreesWithTheReferenceForEveryBroadcast) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 64; ++trial) {
    const Tensor y = random_tensor(
        {pick(random, 0, 3), pick(random, 1, 40), pick(random, 1, 9), pick(random, 1, 9)}, trial);
    Shape shape = y.shape;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      if (trial >> axis & 1U) shape[axis] = 1;
    }
    const Tensor x = random_tensor(shape, 100 + trial);
    Arena arena;
    const FeatureMap from = to_feature_map(x, arena, pick(random, 0, 1));
    FeatureMap sum = to_feature_map(y, arena, 1), product = to_feature_map(y, arena, 1);
    add(sum, from);
    multiply(product, from);
    expect_close(to_tensor(sum), reference::add(y, x), 0.0F);
    expect_close(to_tensor(product), reference::multiply(y, x), 0.0F);
    if (sum.images() > 0) {
      EXPECT_EQ(sum.pixel(0, 0, -1, -1)[0], 0.0F);
    }
  }
}

TEST(Elementwise, WrongShapesAreInputErrors) {
  Arena arena;
  FeatureMap y = to_feature_map(random_tensor({1, 8, 4, 4}, 1), arena);
  const FeatureMap other = to_feature_map(random_tensor({1, 8, 4, 3}, 1), arena);
  const FeatureMap image = to_feature_map(random_tensor({1, 8, 4, 4}, 1), arena, 0, kImageBlock);
  EXPECT_THROW(add(y, other), InputError);
  EXPECT_THROW(multiply(y, to_feature_map(random_tensor({1, 7, 4, 4}, 1), arena)), InputError);
  EXPECT_THROW(add(y, image), InputError);
  const FeatureMap* both[] = {&y, &other};
  EXPECT_THROW(concat(both, arena), InputError);
  EXPECT_THROW(concat({}, arena), InputError);
  EXPECT_THROW(slice_channels(y, 0, 9, arena), InputError);
  EXPECT_THROW(slice_channels(y, -1, 2, arena), InputError);
  EXPECT_THROW(split(y, std::vector<int>{4, 3}, arena), InputError);
  EXPECT_THROW(split(y, std::vector<int>{4, 5}, arena), InputError);
}

}  // namespace
}  // namespace penumbra::nn
