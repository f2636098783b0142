#include "nn/layers/upsample.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::pick;
using test::random_tensor;

TEST(AddUpsampled, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(4);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const int images = pick(random, 1, 2), channels = pick(random, 1, 40);
    const Tensor x = random_tensor({images, channels, pick(random, 1, 8), pick(random, 1, 8)}, trial);
    const Tensor y = random_tensor({images, channels, pick(random, 1, 20), pick(random, 1, 20)}, 100 + trial);
    Arena arena;
    FeatureMap map = to_feature_map(y, arena, 1);
    add_upsampled(to_feature_map(x, arena), map);
    expect_close(to_tensor(map), reference::add_upsampled(x, y), 0.0F);
  }
}

TEST(Upsample, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(5);
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const Tensor x = random_tensor(
        {pick(random, 0, 2), pick(random, 1, 40), pick(random, 1, 12), pick(random, 1, 12)}, trial);
    const int height = pick(random, 1, 40), width = pick(random, 1, 40), border = pick(random, 0, 1);
    Arena arena;
    const FeatureMap map = to_feature_map(x, arena, pick(random, 0, 1));
    expect_close(to_tensor(upsample_nearest(map, height, width, arena, border)),
                 reference::upsample_nearest(x, height, width), 0.0F);
    for (const bool align_corners : {false, true}) {
      expect_close(to_tensor(upsample_bilinear(map, height, width, align_corners, arena, border)),
                   reference::upsample_bilinear(x, height, width, align_corners));
    }
  }
}

TEST(Upsample, ByAFactorRepeatsEveryPixel) {
  const Tensor x = random_tensor({1, 20, 41, 49}, 1);  // 41 and 49: i * (1 / 41) rounds down
  Arena arena;
  const Tensor y = to_tensor(upsample_nearest(to_feature_map(x, arena), 2, arena));
  ASSERT_EQ(y.shape, (Shape{1, 20, 82, 98}));
  for (int i = 0; i < 82; ++i) {
    for (int j = 0; j < 98; ++j) ASSERT_EQ(y.at(0, 17, i, j), x.at(0, 17, i / 2, j / 2));
  }
}

TEST(Upsample, AlignedCornersStayTheCorners) {
  const Tensor x = random_tensor({1, 3, 3, 4}, 2);
  Arena arena;
  const Tensor y = to_tensor(upsample_bilinear(to_feature_map(x, arena), 7, 9, true, arena));
  EXPECT_EQ(y.at(0, 1, 0, 0), x.at(0, 1, 0, 0));
  EXPECT_FLOAT_EQ(y.at(0, 1, 6, 8), x.at(0, 1, 2, 3));
}

TEST(Upsample, EmptySizesAreInputErrors) {
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 4, 2, 2}, 1), arena);
  EXPECT_THROW(upsample_nearest(map, 0, arena), InputError);
  EXPECT_THROW(upsample_bilinear(map, 3, -1, true, arena), InputError);
  FeatureMap other = to_feature_map(random_tensor({1, 5, 2, 2}, 1), arena);
  EXPECT_THROW(add_upsampled(map, other), InputError);
}

}  // namespace
}  // namespace penumbra::nn
