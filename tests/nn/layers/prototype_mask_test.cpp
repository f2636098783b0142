#include "nn/layers/prototype_mask.h"

#include <gtest/gtest.h>

#include <random>

#include "nn/base/error.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

TEST(PrototypeMask, EqualsTheNaiveVersionOnRandomShapes) {
  std::mt19937 random(5);
  long pixels = 0, different = 0;
  for (int round = 0; round < 60; ++round) {
    const int channels = test::pick(random, 1, 40), height = test::pick(random, 1, 12),
              width = test::pick(random, 1, 12);
    const auto seed = static_cast<std::uint32_t>(round);
    const Tensor prototypes = test::random_tensor({1, channels, height, width}, seed);
    const std::vector<float> weights = test::random_vector(channels, seed + 100);
    const int image_width = test::pick(random, 1, 60), image_height = test::pick(random, 1, 60);
    const PrototypeFrame frame{0.25F * static_cast<float>(test::pick(random, 0, 4)), 0.5F,
                               static_cast<float>(width) / static_cast<float>(image_width), 0.3F};
    const auto place = [&](int extent) {
      return static_cast<float>(test::pick(random, 0, 10 * extent)) / 10;
    };
    Box box{place(image_width), place(image_height), place(image_width), place(image_height)};
    if (box.x2 < box.x1) std::swap(box.x1, box.x2);
    if (box.y2 < box.y1) std::swap(box.y1, box.y2);
    Arena arena;
    Mask mask{0, 0, 1, 1, {1}};  // is overwritten
    std::vector<float> scratch(static_cast<std::size_t>(height * width));
    prototype_mask(to_feature_map(prototypes, arena), weights, frame, box, image_width, image_height, 0.5F,
                   scratch, mask);
    const std::vector<std::uint8_t> expected =
        reference::prototype_mask(prototypes, weights, frame, box, image_width, image_height, 0.5F);
    for (int y = 0; y < image_height; ++y) {
      for (int x = 0; x < image_width; ++x) {
        ++pixels;
        different += mask.contains(x, y) != (expected[static_cast<std::size_t>(y * image_width + x)] != 0);
      }
    }
  }
  EXPECT_LE(different, pixels / 10000) << "only probabilities within rounding of the threshold may differ";
}

TEST(PrototypeMask, ABoxWithoutPixelsGivesAnEmptyMask) {
  Arena arena;
  const FeatureMap prototypes = to_feature_map(test::random_tensor({1, 2, 3, 3}, 1), arena);
  const std::vector<float> weights{1.0F, -1.0F};
  for (const Box& box :
       {Box{2.0F, 2.0F, 2.0F, 5.0F}, Box{1.2F, 1.2F, 1.8F, 1.8F}, Box{9.0F, 9.0F, 9.0F, 9.0F}}) {
    Mask mask{0, 0, 1, 1, {1}};
    std::vector<float> scratch(9);
    prototype_mask(prototypes, weights, {}, box, 9, 9, 0.5F, scratch, mask);
    EXPECT_TRUE(mask.bits.empty());
    EXPECT_EQ(mask.width * mask.height, 0);
    EXPECT_THROW(prototype_mask(prototypes, weights, {}, box, 9, 9, 0.5F, std::span(scratch).first(8), mask),
                 InputError);
  }
}

}  // namespace
}  // namespace penumbra::nn
