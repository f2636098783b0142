#include "slam/evaluation/depth_mask_evaluation.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

Instance rectangle(const Rect& region) {
  Instance instance;
  instance.region = region;
  instance.mask = ByteImage::filled(region.width, region.height, 255);
  return instance;
}

TEST(DepthMaskEvaluation, TellsHowAnObjectIsSeen) {
  FloatImage depth = FloatImage::filled(100, 80, 3.0F);
  Instance object = rectangle({40, 20, 20, 40});
  for (int y = 0; y < 40; ++y) object.mask.at(0, y) = 0;
  EXPECT_EQ(view_of(object, depth), ObjectView::whole);
  object.region.x = 0;
  EXPECT_EQ(view_of(object, depth), ObjectView::cut);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 6; ++x) {
      object.mask.at(x, y) = 0;
      depth.at(x, 20 + y) = 2.5F;
    }
  }
  EXPECT_EQ(view_of(object, depth), ObjectView::behind);
}

TEST(DepthMaskEvaluation, MasksOverlapByTheirPixels) {
  const Instance a = rectangle({10, 10, 20, 10}), b = rectangle({20, 10, 20, 10});
  EXPECT_DOUBLE_EQ(mask_iou(a, a), 1.0);
  EXPECT_DOUBLE_EQ(mask_iou(a, b), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(mask_iou(a, rectangle({50, 50, 5, 5})), 0.0);
  EXPECT_DOUBLE_EQ(mask_iou(Instance(), Instance()), 0.0);
}

TEST(DepthMaskEvaluation, BoxesAreOffByAtMostTheShare) {
  const Rect box{100, 100, 200, 100};
  EXPECT_EQ(jittered(box, 0.0, 1, {640, 480}), box);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Rect off = jittered(box, 0.05, seed, {640, 480});
    EXPECT_LE(std::abs(off.x - box.x), 10);
    EXPECT_LE(std::abs(off.x + off.width - 300), 10);
    EXPECT_LE(std::abs(off.y - box.y), 5);
    EXPECT_LE(std::abs(off.y + off.height - 200), 5);
    const Rect inside = jittered({0, 0, 640, 480}, 0.1, seed, {640, 480});
    EXPECT_EQ(intersection(inside, {0, 0, 640, 480}), inside);
  }
}

TEST(DepthMaskEvaluation, CountsWhatARepairDid) {
  const Instance object = rectangle({0, 0, 4, 1});
  Instance wide = object;
  wide.region.width = 6;
  wide.mask = ByteImage::filled(6, 1, 255);
  wide.mask.at(4, 0) = wide.mask.at(5, 0) = 0;
  const FloatImage clean = FloatImage::filled(6, 1, 2.0F);
  FloatImage raw = FloatImage::filled(6, 1, 0.0F), repaired = FloatImage::filled(6, 1, 0.0F);
  raw.at(0, 0) = repaired.at(0, 0) = 2.0F;
  repaired.at(1, 0) = 2.1F;
  repaired.at(2, 0) = 1.9F;
  repaired.at(4, 0) = 1.5F;
  repaired.at(5, 0) = 2.05F;
  RepairCount count;
  count_repair(wide, raw, repaired, clean, count);
  EXPECT_EQ(count.holes, 3);
  EXPECT_EQ(count.filled, 2);
  EXPECT_NEAR(count.rmse(), 0.1, 1e-6);
  EXPECT_EQ(count.background, 2);
  EXPECT_EQ(count.wrong, 1);
  EXPECT_EQ(RepairCount().rmse(), 0.0);
}

}  // namespace
}  // namespace penumbra::slam
