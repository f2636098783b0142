// Masks as runs, against plain bitmaps.
#include "nn/evaluation/run_mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace penumbra::nn {
namespace {

// Column by column.
using Bitmap = std::vector<char>;

Bitmap random_bitmap(std::mt19937& random, std::size_t pixels) {
  Bitmap bits(pixels);
  const unsigned change = 1 + random() % 9;
  char value = 0;
  for (char& bit : bits) bit = value = static_cast<char>(random() % change == 0 ? 1 - value : value);
  return bits;
}

RunMask to_runs(const Bitmap& bits, int width, int height) {
  std::vector<std::uint32_t> counts{0};
  char value = 0;
  for (const char bit : bits) {
    if (bit != value) counts.push_back(0);
    value = bit;
    ++counts.back();
  }
  return mask_from_counts(counts, width, height);
}

Bitmap to_bitmap(const RunMask& mask) {
  Bitmap bits(static_cast<std::size_t>(mask.width * mask.height));
  for (const PixelRun& run : mask.runs) std::fill(bits.begin() + run.begin, bits.begin() + run.end, 1);
  return bits;
}

CocoBox naive_bounding_box(const Bitmap& bits, int width, int height) {
  int left = width, right = -1, top = height, bottom = -1;
  for (int i = 0; i < width * height; ++i) {
    if (bits[static_cast<std::size_t>(i)] == 0) continue;
    left = std::min(left, i / height);
    right = std::max(right, i / height);
    top = std::min(top, i % height);
    bottom = std::max(bottom, i % height);
  }
  if (right < 0) return {};
  return {double(left), double(top), double(right - left + 1), double(bottom - top + 1)};
}

TEST(RunMask, AgreesWithBitmapsOnRandomMasks) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const int width = 1 + static_cast<int>(random() % 12), height = 1 + static_cast<int>(random() % 12);
    const auto pixels = static_cast<std::size_t>(width * height);
    const Bitmap a = random_bitmap(random, pixels), b = random_bitmap(random, pixels);
    const RunMask runs_a = to_runs(a, width, height), runs_b = to_runs(b, width, height);
    ASSERT_EQ(to_bitmap(runs_a), a);
    Bitmap both(pixels), any(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      both[i] = a[i] & b[i];
      any[i] = a[i] | b[i];
    }
    const auto count = [](const Bitmap& bits) {
      return static_cast<std::uint64_t>(std::count(bits.begin(), bits.end(), 1));
    };
    EXPECT_EQ(area(runs_a), count(a));
    EXPECT_EQ(bounding_box(runs_a), naive_bounding_box(a, width, height));
    EXPECT_EQ(intersection_area(runs_a, runs_b), count(both));
    EXPECT_EQ(mask_union(std::vector{runs_a, runs_b}, width, height), to_runs(any, width, height));
    if (count(both) == 0) {
      EXPECT_EQ(detection_iou(runs_a, runs_b, false), 0.0);
    } else {
      EXPECT_DOUBLE_EQ(detection_iou(runs_a, runs_b, false), double(count(both)) / double(count(any)));
      EXPECT_DOUBLE_EQ(detection_iou(runs_a, runs_b, true), double(count(both)) / double(count(a)));
    }
  }
}

TEST(RunMask, EmptyMasksHaveNoAreaNoBoxAndNoOverlap) {
  const RunMask empty = mask_from_counts(std::vector<std::uint32_t>{12}, 4, 3);
  const RunMask full = mask_from_counts(std::vector<std::uint32_t>{0, 12}, 4, 3);
  EXPECT_EQ(area(empty), 0U);
  EXPECT_EQ(bounding_box(empty), CocoBox{});
  EXPECT_EQ(bounding_box(full), (CocoBox{0, 0, 4, 3}));
  EXPECT_EQ(detection_iou(empty, empty, false), 0.0);
  EXPECT_EQ(detection_iou(empty, full, true), 0.0);
  EXPECT_EQ(mask_union({}, 4, 3), empty);
}

TEST(RunMask, RunsOfLengthZeroJoinTheirNeighbours) {
  const std::vector<std::uint32_t> counts{2, 3, 0, 4, 3, 0};
  EXPECT_EQ(mask_from_counts(counts, 4, 3).runs, (std::vector<PixelRun>{{2, 9}}));
}

TEST(RunMask, BoxesOverlapAsRectangles) {
  const CocoBox a{0, 0, 10, 10}, b{5, 0, 10, 20};
  EXPECT_DOUBLE_EQ(detection_iou(a, b, false), 50.0 / 250.0);
  EXPECT_DOUBLE_EQ(detection_iou(a, b, true), 0.5);
  EXPECT_EQ(detection_iou(a, CocoBox{10, 0, 5, 5}, false), 0.0);
  EXPECT_EQ(detection_iou(CocoBox{3, 3, 0, 0}, a, true), 0.0);
}

}  // namespace
}  // namespace penumbra::nn
