#include "slam/dynamics/rgbd/depth_masks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

constexpr int kMasksWidth = 320, kMasksHeight = 240;
const StereoCamera kMasksCamera{260.0, 260.0, 159.5, 119.5, 0.08, kMasksWidth, kMasksHeight};
const Rect kMasksBody{120, 60, 70, 150};

// A person 2 m away before a wall, whose pixels at the right of the body are shadow, without depth.
ImageToSegment view(int frame) {
  ImageToSegment from{frame, ByteImage::filled(kMasksWidth, kMasksHeight, 120, 3),
                      FloatImage::filled(kMasksWidth, kMasksHeight, 4.0F)};
  for (int y = kMasksBody.y; y < kMasksBody.y + kMasksBody.height; ++y) {
    for (int x = kMasksBody.x; x < kMasksBody.x + kMasksBody.width + 6; ++x) {
      const bool is_shadow = x >= kMasksBody.x + kMasksBody.width;
      from.depth.at(x, y) = is_shadow ? 0.0F : 2.0F;
      for (int c = 0; c < 3 && !is_shadow; ++c) from.image.at(x, y, c) = 60;
    }
  }
  return from;
}

Instance box(const Rect& region, float score = 0.9F) {
  Instance instance;
  instance.class_name = "person";
  instance.score = score;
  instance.region = region;
  return instance;
}

std::vector<Instance> masks(const std::vector<Instance>& boxes, const ImageToSegment& from,
                            const DepthMaskSettings& settings = {}) {
  return masks_from_depth([&](const ImageToSegment&) { return boxes; }, kMasksCamera, 0.5, settings)(from);
}

double iou(const Instance& found, const Rect& truth) {
  int shared = 0, joint = 0;
  for (int y = 0; y < kMasksHeight; ++y) {
    for (int x = 0; x < kMasksWidth; ++x) {
      shared += found.contains(x, y) && truth.contains(x, y);
      joint += found.contains(x, y) || truth.contains(x, y);
    }
  }
  return shared / static_cast<double>(joint);
}

TEST(DepthMasks, MakesMasksOfBoxes) {
  const Rect region{110, 55, 95, 160};
  const std::vector<Instance> found = masks({box(region), box({10, 10, 20, 20}, 0.3F)}, view(0));
  ASSERT_EQ(found.size(), 1U);  // the other's score is too low
  EXPECT_EQ(found[0].class_name, "person");
  EXPECT_EQ(found[0].region, region);
  EXPECT_GT(iou(found[0], kMasksBody), 0.95);
  EXPECT_FALSE(found[0].moves);  // nothing is known after one image
}

TEST(DepthMasks, CutsBoxesAtTheImage) {
  ImageToSegment from = view(0);
  const std::vector<Instance> found = masks(
      {box({-50, 55, 255, 300}), box({400, 10, 50, 50}), box({-60, -60, 40, 40}), box({5, 5, 0, 0})}, from);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].region, (Rect{0, 55, 205, 185}));
  EXPECT_GT(iou(found[0], kMasksBody), 0.95);
}

TEST(DepthMasks, ABoxWithoutAnyDepthIsItsOwnMask) {
  ImageToSegment from = view(0);
  from.depth.fill(0.0F);
  const std::vector<Instance> found = masks({box(kMasksBody)}, from);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(iou(found[0], kMasksBody), 1.0);
}

TEST(DepthMasks, AnImageWithoutDepthHasBoxes) {
  ImageToSegment from = view(0);
  from.depth = {};
  const std::vector<Instance> found = masks({box({-10, 60, 100, 150})}, from);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(iou(found[0], {0, 60, 90, 150}), 1.0);
}

TEST(DepthMasks, RefusesDepthOfAnotherSize) {
  ImageToSegment from = view(7);
  from.depth = FloatImage::filled(kMasksWidth / 2, kMasksHeight / 2, 1.0F);
  test::expect_error<InputError>([&] { masks({box(kMasksBody)}, from); },
                                 {"frame 7, depth", "320x240", "160x120"});
}

TEST(DepthMasks, LeavesTheDepthAsItWas) {
  const ImageToSegment from = view(0);
  const FloatImage before = from.depth.clone();
  masks({box({110, 55, 95, 160})}, from);
  EXPECT_TRUE(std::equal(before.data(), before.data() + before.elements(), from.depth.data()));
}

// A box that shows two things as well as each other: the one that was there before.
TEST(DepthMasks, RemembersTheDepthOfAnObject) {
  ImageToSegment from = view(0);
  const Rect left{60, 60, 60, 120}, right{160, 60, 60, 120}, both{60, 60, 160, 120};
  for (const int frame : {0, 1}) {
    for (const bool is_left : {true, false}) {
      from.depth.fill(5.0F);
      for (int y = 60; y < 180; ++y) {
        for (int x = 0; x < 60; ++x) {
          from.depth.at(60 + x, y) = 1.5F;
          from.depth.at(160 + x, y) = 2.5F;
        }
      }
      const Rect& first = is_left ? left : right;
      std::vector<Instance> boxes = {box(frame == 0 ? first : both)};
      const Segmenter segmenter =
          masks_from_depth([&](const ImageToSegment&) { return boxes; }, kMasksCamera, 0.5, {});
      from.frame = 0;
      boxes = {box({first.x - 20, first.y, 100, 120})};
      const std::vector<Instance> before = segmenter(from);
      EXPECT_GT(iou(before[0], first), 0.9);
      from.frame = 1;
      boxes = {box(both)};
      EXPECT_GT(iou(segmenter(from)[0], first), 0.9) << is_left;
    }
  }
}

TEST(DepthMasks, SaysWhatMoves) {
  // A wall of noise that stands before a camera that moves to the right, and a person who walks down.
  const auto noise = [](double x, double y) {
    const auto at = [](int a, int b) {
      return counter_uniform(5, static_cast<std::uint64_t>((a + 500) * 1000 + b + 500));
    };
    const int i = static_cast<int>(std::floor(x / 6.0)), j = static_cast<int>(std::floor(y / 6.0));
    const double s = x / 6.0 - i, t = y / 6.0 - j;
    return (1 - s) * (1 - t) * at(i, j) + s * (1 - t) * at(i + 1, j) + (1 - s) * t * at(i, j + 1) +
           s * t * at(i + 1, j + 1);
  };
  for (const double falls : {0.0, 3.0}) {
    const std::vector<Instance> boxes = {box({110, 55, 95, 160})};
    const Segmenter segmenter =
        masks_from_depth([&](const ImageToSegment&) { return boxes; }, kMasksCamera, 0.5, {});
    std::vector<Instance> found;
    for (int frame = 0; frame < 3; ++frame) {
      ImageToSegment from = view(frame);
      for (int y = 0; y < kMasksHeight; ++y) {
        for (int x = 0; x < kMasksWidth; ++x) {
          const bool is_body = kMasksBody.contains(x, y);
          const double layer = 1.0 + (y / 40) % 3;
          const double value =
              is_body ? noise(x + 400.0 + 4.0 * frame, y - falls * frame) : noise(x + layer * frame, y);
          for (int c = 0; c < 3; ++c)
            from.image.at(x, y, c) = static_cast<std::uint8_t>(20.0 + 200.0 * value);
        }
      }
      found = segmenter(from);
    }
    ASSERT_EQ(found.size(), 1U);
    ASSERT_TRUE(found[0].moves);
    EXPECT_EQ(*found[0].moves, falls > 0.0);
  }
}

TEST(MasksOfBoxes, AreTheBoxes) {
  const Segmenter boxes = [](const ImageToSegment&) {
    return std::vector<Instance>{box({-10, 10, 40, 30}), box({500, 10, 40, 30})};
  };
  const std::vector<Instance> found = masks_of_boxes(boxes)(view(0));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].region, (Rect{0, 10, 30, 30}));
  EXPECT_EQ(iou(found[0], {0, 10, 30, 30}), 1.0);
}

}  // namespace
}  // namespace penumbra::slam
