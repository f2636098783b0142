#include "slam/dynamics/rgbd/dbscan_masks.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"
#include "nn/image/shapes.h"
#include "slam/frontend/features/frame_features.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

constexpr int kImageWidth = 320, kImageHeight = 240;
const Rect kPersonBox{100, 40, 80, 160}, kPersonBody{110, 44, 60, 150};

// A body 2 m away before a wall 4 m away; a floor that rises from 1.2 m, below the box, runs on beside it.
FloatImage room() {
  FloatImage depth(kImageWidth, kImageHeight, 1);
  for (int y = 0; y < kImageHeight; ++y) {
    for (int x = 0; x < kImageWidth; ++x) {
      depth.at(x, y) = y > 200 ? 1.2F : 4.0F;
      if (kPersonBody.contains(x, y)) depth.at(x, y) = 2.0F + 0.002F * static_cast<float>(x - kPersonBody.x);
    }
  }
  return depth;
}

std::shared_ptr<const FrameFeatures> features_of(const FloatImage& depth, int count) {
  auto features = std::make_shared<FrameFeatures>();
  for (int i = 0; i < count; ++i) {
    const auto n = static_cast<std::uint64_t>(i);
    const int x = static_cast<int>(counter_random(1, n) % kImageWidth);
    const int y = static_cast<int>(counter_random(2, n) % kImageHeight);
    features->left.keypoints.push_back({static_cast<float>(x), static_cast<float>(y), 0, 0.0F, 1.0F});
    features->left.descriptors.emplace_back();
    features->depth.push_back(depth.at(x, y) > 0.0F ? depth.at(x, y) : -1.0F);
    features->u_right.push_back(depth.at(x, y) > 0.0F ? 0.0F : -1.0F);
  }
  return features;
}

Segmenter one_box(const Rect& box, float score = 0.9F) {
  return [box, score](const ImageToSegment&) {
    Instance person;
    person.class_name = "person";
    person.region = box;
    person.score = score;
    return std::vector<Instance>{person};
  };
}

double share_found(const Instance& found, const FloatImage& depth, bool of_body) {
  int inside = 0, all = 0;
  for (int y = found.region.y; y < found.region.y + found.region.height; ++y) {
    for (int x = found.region.x; x < found.region.x + found.region.width; ++x) {
      if (kPersonBody.contains(x, y) != of_body || !(depth.at(x, y) > 0.0F)) continue;
      ++all;
      inside += found.contains(x, y);
    }
  }
  return inside / static_cast<double>(all);
}

TEST(DbscanMasks, TakesThePersonAndLeavesTheWall) {
  FloatImage depth = room();
  const auto features = features_of(depth, 1500);
  // Holes at the body's left edge go with what is next to them.
  for (int y = 60; y < 80; ++y) {
    for (int x = kPersonBody.x + 5; x < kPersonBody.x + 20; ++x) depth.at(x, y) = 0.0F;
  }
  const ByteImage image = ByteImage::filled(kImageWidth, kImageHeight, 100);
  for (const ForegroundMode mode : {ForegroundMode::adaptive, ForegroundMode::paper}) {
    ForegroundSettings settings;
    settings.mode = mode;
    const std::vector<Instance> found =
        masks_by_dbscan(one_box(kPersonBox), 0.5, settings)({0, image, depth, features});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].region, kPersonBox);
    EXPECT_EQ(share_found(found[0], depth, false), 0.0);
    // The letter splits the body: eps at the knee is a step between neighbouring depths.
    if (mode == ForegroundMode::adaptive) {
      EXPECT_EQ(share_found(found[0], depth, true), 1.0);
      EXPECT_TRUE(found[0].contains(kPersonBody.x + 10, 70));
    }
  }
}

// What is nearest in the box is a desk that goes on beside it; the lowest mean depth is the desk's.
TEST(DbscanMasks, ADeskBeforeThePersonIsNotThePerson) {
  FloatImage depth = room();
  for (int y = 150; y < kImageHeight; ++y) {
    for (int x = 0; x < kImageWidth; ++x) depth.at(x, y) = 1.2F;
  }
  const auto features = features_of(depth, 1500);
  const ByteImage image = ByteImage::filled(kImageWidth, kImageHeight, 100);
  ForegroundSettings adaptive;
  adaptive.mode = ForegroundMode::adaptive;
  const Instance ours = masks_by_dbscan(one_box(kPersonBox), 0.5, adaptive)({0, image, depth, features})[0];
  EXPECT_TRUE(ours.contains(140, 100));
  EXPECT_FALSE(ours.contains(140, 180));
  ForegroundSettings letter;
  letter.mode = ForegroundMode::paper;
  const Instance theirs = masks_by_dbscan(one_box(kPersonBox), 0.5, letter)({0, image, depth, features})[0];
  EXPECT_FALSE(theirs.contains(140, 100));
  EXPECT_TRUE(theirs.contains(140, 180));
}

TEST(DbscanMasks, WhereDepthSaysNothingTheBoxIsTheMask) {
  const FloatImage depth = room(), empty = FloatImage::filled(kImageWidth, kImageHeight, 0.0F);
  const ByteImage image = ByteImage::filled(kImageWidth, kImageHeight, 100);
  ForegroundSettings adaptive;
  adaptive.mode = ForegroundMode::adaptive;
  const auto whole = [&](const ImageToSegment& from) {
    const std::vector<Instance> found = masks_by_dbscan(one_box({-20, 40, 100, 100}), 0.5, adaptive)(from);
    return found.size() == 1 && found[0].region == Rect{0, 40, 80, 100} &&
           count_pixels(found[0].mask) == 80 * 100;
  };
  EXPECT_TRUE(whole({0, image, {}, features_of(depth, 500)}));     // no depth image
  EXPECT_TRUE(whole({0, image, depth, nullptr}));                  // no features
  EXPECT_TRUE(whole({0, image, empty, features_of(empty, 500)}));  // no depths
  EXPECT_TRUE(whole({0, image, depth, features_of(depth, 3)}));    // too few
  EXPECT_TRUE(masks_by_dbscan(one_box({400, 0, 10, 10}), 0.5, {})({0, image, depth, nullptr}).empty());
  EXPECT_TRUE(masks_by_dbscan(one_box(kPersonBox, 0.3F), 0.5, {})({0, image, depth, nullptr}).empty());
}

TEST(DbscanMasks, RefusesDepthOfAnotherSize) {
  const ByteImage image = ByteImage::filled(kImageWidth, kImageHeight, 100);
  test::expect_error<InputError>(
      [&] {
        masks_by_dbscan(one_box(kPersonBox), 0.5, {})({3, image, FloatImage(160, 120, 1), nullptr});
      },
      {"frame 3, depth", "320x240", "160x120"});
}

}  // namespace
}  // namespace penumbra::slam
