// Anchors, box coder, NMS, RoIAlign and mask paste.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "nn/base/error.h"
#include "nn/layers/anchor_generator.h"
#include "nn/layers/box_coder.h"
#include "nn/layers/nms.h"
#include "nn/layers/reference/reference.h"
#include "nn/layers/roi_align.h"
#include "tests/support/image_cases.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::pick;
using test::random_tensor;

std::vector<Box> random_boxes(std::mt19937& random, int count, float extent) {
  std::uniform_real_distribution<float> position(-0.2F * extent, 1.2F * extent), size(0.0F, 0.7F * extent);
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const float x = position(random), y = position(random);
    boxes.push_back({x, y, x + size(random), y + size(random)});
  }
  return boxes;
}

class RegionsByKernels : public test::EveryIsa {};

TEST_P(RegionsByKernels, RoiAlignAgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(1);
  for (std::uint32_t trial = 0; trial < 120; ++trial) {
    const Tensor map =
        random_tensor({1, pick(random, 1, 100), pick(random, 1, 20), pick(random, 1, 20)}, trial);
    const std::vector<Box> boxes = random_boxes(random, pick(random, 0, 6), 80.0F);
    const RoiAlignOptions options{pick(random, 1, 8), pick(random, 0, 3), trial % 2 == 0};
    Arena arena;
    const FeatureMap feature_map = to_feature_map(map, arena, pick(random, 0, 1));
    const PyramidLevel level{&feature_map, 0.25F};
    const Tensor expected = reference::roi_align(map, 0.25F, boxes, options);
    test::expect_close(
        to_tensor(multi_scale_roi_align({&level, 1}, boxes, options, arena, pick(random, 0, 1))), expected);
    test::expect_close(to_tensor(roi_align(feature_map, 0.25F, boxes, options, arena)), expected);
  }
}

TEST(RoiAlign, SenselessRegionsNeitherHangNorCrash) {
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 16, 4, 4}, 1), arena);
  const std::vector<Box> boxes{
      {-1e30F, -1e30F, 1e30F, 1e30F}, {3, 3, 1, 1}, {NAN, 0, 1, NAN}, {0, 0, 1e9F, 2}};
  for (const bool aligned : {false, true}) {
    const FeatureMap y = roi_align(map, 1.0F, boxes, {7, 0, aligned}, arena);
    for (const float value : to_tensor(y).values) EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(RoiAlign, SenselessOptionsAreInputErrors) {
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 16, 4, 4}, 1), arena);
  EXPECT_THROW(roi_align(map, 1.0F, {}, {0, 2, false}, arena), InputError);
  EXPECT_THROW(roi_align(map, 1.0F, {}, {7, -1, false}, arena), InputError);
  EXPECT_THROW(multi_scale_roi_align({}, {}, {}, arena), InputError);
}

TEST(RoiAlign, PicksTheLevelByTheSquareRootOfTheArea) {
  EXPECT_EQ(roi_level({0, 0, 224, 224}, 4), 2);
  EXPECT_EQ(roi_level({0, 0, 223, 223}, 4), 1);
  EXPECT_EQ(roi_level({0, 0, 448, 448}, 4), 3);
  EXPECT_EQ(roi_level({0, 0, 1e6, 1e6}, 4), 3);
  EXPECT_EQ(roi_level({5, 5, 5, 5}, 4), 0);
}

TEST(Nms, AgreesWithTheReferenceOnRandomBoxes) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    const int count = pick(random, 0, 200);
    const std::vector<Box> boxes = random_boxes(random, count, 100.0F);
    std::vector<float> scores;
    std::vector<int> groups;
    for (int i = 0; i < count; ++i) {
      scores.push_back(static_cast<float>(pick(random, 0, 50)) / 50.0F);  // with ties
      groups.push_back(pick(random, 0, 2));
    }
    const float threshold = static_cast<float>(pick(random, 1, 9)) / 10.0F;
    const int most = pick(random, 0, 1) == 0 ? 10 : 1000;
    EXPECT_EQ(batched_nms(boxes, scores, groups, threshold, most),
              reference::batched_nms(boxes, scores, groups, threshold, most));
  }
}

// Corners on a grid, so that many overlaps are the threshold to the last bit, and boxes without an area.
TEST_P(RegionsByKernels, NmsDecidesExactlyAtTheThreshold) {
  std::mt19937 random(3);
  for (const float threshold : {0.0F, 0.25F, 0.5F, 0.7F, 1.0F}) {
    std::vector<Box> boxes;
    std::vector<float> scores;
    std::vector<int> groups;
    for (int i = 0; i < 1500; ++i) {
      const auto corner = [&] { return 2.0F * static_cast<float>(pick(random, 0, 20)); };
      const auto side = [&] { return static_cast<float>(pick(random, 0, 10)); };
      const float x = corner(), y = corner();
      boxes.push_back({x, y, x + side(), y + side()});
      scores.push_back(std::uniform_real_distribution<float>()(random));
      groups.push_back(pick(random, 0, 1));
    }
    const std::vector<int> kept = batched_nms(boxes, scores, groups, threshold, 1500);
    EXPECT_GT(kept.size(), 40U);  // more than a register of them
    EXPECT_EQ(kept, reference::batched_nms(boxes, scores, groups, threshold, 1500));
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, RegionsByKernels, test::every_isa(), test::isa_name);

TEST(Nms, EmptyBoxesSuppressNothing) {
  const std::vector<Box> boxes{{1, 1, 1, 1}, {1, 1, 1, 1}};
  EXPECT_EQ(batched_nms(boxes, std::vector{0.5F, 0.9F}, std::vector{0, 0}, 0.5F, 10), (std::vector{1, 0}));
}

TEST(AnchorGenerator, GivesTorchvisionsBaseAnchors) {
  const std::vector<float> ratios{0.5F, 1.0F, 2.0F};
  const std::vector<Box> anchors = base_anchors(32.0F, ratios);
  ASSERT_EQ(anchors.size(), 3U);
  EXPECT_EQ(anchors[0].x1, -23.0F);
  EXPECT_EQ(anchors[0].y2, 11.0F);
  EXPECT_EQ(anchors[1].x1, -16.0F);
  EXPECT_EQ(anchors[2].x2, 11.0F);
  EXPECT_EQ(anchors[2].y1, -23.0F);
}

TEST(BoxCoder, ZeroDeltasGiveTheReferenceAndLargeOnesAreClamped) {
  const Box box{10, 20, 30, 60};
  const Box same = decode_box(box, 0, 0, 0, 0, {});
  EXPECT_FLOAT_EQ(same.x1, 10);
  EXPECT_FLOAT_EQ(same.y2, 60);
  const Box moved = decode_box(box, 10, -10, 0, 0, {10, 10, 5, 5});  // by one width and one height
  EXPECT_FLOAT_EQ(moved.x1, 30);
  EXPECT_FLOAT_EQ(moved.y1, -20);
  const Box large = decode_box(box, 0, 0, 1e30F, 1e30F, {});
  EXPECT_NEAR(large.width(), 20.0F * 1000.0F / 16.0F, 0.01F);
}

TEST(MaskPaste, AgreesWithTheReferenceOnRandomBoxes) {
  std::mt19937 random(5);
  int different = 0, pixels = 0;
  for (std::uint32_t trial = 0; trial < 80; ++trial) {
    const int size = pick(random, 1, 28), width = pick(random, 1, 90), height = pick(random, 1, 90);
    Tensor probabilities = random_tensor({size, size}, trial);
    for (float& p : probabilities.values) p = 0.5F + 0.5F * p;
    const Box box = random_boxes(random, 1, 80.0F).front();
    const Mask mask = paste_mask(probabilities.values, size, box, width, height);
    const std::vector<std::uint8_t> expected =
        reference::paste_mask(probabilities.values, size, box, width, height, 0.5F);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        different += mask.contains(x, y) != (expected[static_cast<std::size_t>(y * width + x)] != 0);
        pixels += 1;
      }
    }
  }
  // The two round differently where the probability is the threshold to the last bit.
  EXPECT_LE(different, pixels / 100000);
}

TEST(MaskPaste, BoxesOutsideTheImageGiveEmptyMasks) {
  const std::vector<float> ones(28 * 28, 1.0F);
  for (const Box& box : {Box{-50, -50, -20, -20}, Box{200, 10, 250, 30}, Box{10, 200, 30, 250}}) {
    EXPECT_TRUE(paste_mask(ones, 28, box, 100, 100).bits.empty());
  }
}

}  // namespace
}  // namespace penumbra::nn
