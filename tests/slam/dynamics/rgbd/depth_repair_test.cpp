#include "slam/dynamics/rgbd/depth_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "nn/base/counter_random.h"
#include "tests/support/allocation_counter.h"

namespace penumbra::slam {
namespace {

struct RepairScene {
  ByteImage grey;
  FloatImage depth;
};

// Two surfaces, an edge between them in grey and depth, noise on both, and holes: single ones, a block, and a
// band at the right border.
RepairScene make_scene(int width, int height, std::uint64_t seed) {
  RepairScene scene{ByteImage(width, height), FloatImage(width, height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto n = static_cast<std::uint64_t>(y * width + x);
      const bool near = x > width / 3 + y / 8;
      const double noise = counter_uniform(seed, 2 * n) - 0.5;
      scene.grey.at(x, y) = static_cast<std::uint8_t>((near ? 120 : 126) + 6.0 * noise + y / 9);
      scene.depth.at(x, y) = static_cast<float>((near ? 1.5 : 2.8) + 0.02 * noise + 0.0005 * x);
      const bool block = x > width / 2 && x < width / 2 + 15 && y > height / 4 && y < height / 2;
      const bool hole = counter_uniform(seed, 2 * n + 1) < 0.2 || block || x >= width - 12;
      if (hole) scene.depth.at(x, y) = 0.0F;
    }
  }
  return scene;
}

// The formula of depth_repair.h, pixel by pixel.
float guarded_mean(const ByteView& grey, const FloatImage& depth, int x, int y, const Size& reach,
                   int difference) {
  double sum = 0.0;
  int count = 0;
  for (int v = std::max(0, y - reach.height); v <= std::min(depth.height() - 1, y + reach.height); ++v) {
    for (int u = std::max(0, x - reach.width); u <= std::min(depth.width() - 1, x + reach.width); ++u) {
      const float z = depth.at(u, v);
      if (!(z > 0.0F) || std::abs(grey.at(u, v) - grey.at(x, y)) >= difference) continue;
      sum += static_cast<double>(z);
      ++count;
    }
  }
  return count == 0 ? 0.0F : static_cast<float>(sum / count);
}

int repair_naively(const ByteView& grey, const Rect& box, bool reuses, FloatImage& depth) {
  const Size reach{std::max(4, box.width / 10) / 2, std::max(4, box.height / 10) / 2};
  const Rect inside = intersection(box, {0, 0, depth.width(), depth.height()});
  const FloatImage before = depth.clone();
  int filled = 0;
  const auto repair = [&](int x, int y) {
    if (depth.at(x, y) > 0.0F) return;
    const float z = guarded_mean(grey, reuses ? depth : before, x, y, reach, 5);
    depth.at(x, y) = z;
    filled += z > 0.0F;
  };
  for (int y = inside.y; y < inside.y + inside.height; ++y) {
    for (int x = inside.x; x < inside.x + inside.width; ++x) repair(x, y);
  }
  if (!reuses) return filled;
  for (int y = inside.y + inside.height - 1; y >= inside.y; --y) {
    for (int x = inside.x + inside.width - 1; x >= inside.x; --x) repair(x, y);
  }
  return filled;
}

double share_of_holes(const FloatImage& depth, const Rect& box) {
  int holes = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) holes += depth.at(x, y) == 0.0F;
  }
  return holes / static_cast<double>(box.area());
}

TEST(DepthRepair, EqualsTheFormulaPixelByPixel) {
  for (const Rect& box : {Rect{20, 15, 60, 80}, Rect{-10, 40, 90, 90}, Rect{50, 30, 9, 7},
                          Rect{-5, -5, 200, 200}, Rect{119, 99, 1, 1}}) {
    for (const bool reuses : {false, true}) {
      RepairScene scene = make_scene(120, 100, 7);
      FloatImage expected = scene.depth.clone();
      const int expected_filled = repair_naively(scene.grey, box, reuses, expected);
      DepthRepair repair(DepthRepairSettings{reuses ? RepairMode::border : RepairMode::paper});
      EXPECT_EQ(repair.apply(scene.grey, box, scene.depth), expected_filled);
      for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 120; ++x)
          ASSERT_NEAR(scene.depth.at(x, y), expected.at(x, y), 2e-4) << x << "," << y;
      }
    }
  }
}

// Where cells are pixels and all depths are near each other, the two forms by cells are the formula's too.
TEST(DepthRepair, CellsOfOnePixelAreTheFormulaInASmallBox) {
  const Rect box{30, 30, 40, 40};  // its window is 5 x 5
  for (const RepairMode mode : {RepairMode::median, RepairMode::modes}) {
    RepairScene scene = make_scene(120, 100, 3);
    for (float& z : std::span(scene.depth.data(), scene.depth.elements())) z = z > 0.0F ? 2.0F : 0.0F;
    FloatImage expected = scene.depth.clone();
    repair_naively(scene.grey, box, /*reuses=*/true, expected);
    DepthRepair(DepthRepairSettings{mode}).apply(scene.grey, box, scene.depth);
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 120; ++x) {
        if (expected.at(x, y) == 0.0F) continue;
        ASSERT_NEAR(scene.depth.at(x, y), expected.at(x, y), 1e-5);
      }
    }
  }
}

TEST(DepthRepair, TheLargerOfTwoModesLiesOnASurface) {
  for (const RepairMode mode : {RepairMode::median, RepairMode::modes}) {
    RepairScene scene = make_scene(240, 200, 5);
    scene.grey.fill(100);  // the guard tells nothing
    const FloatImage before = scene.depth.clone();
    const Rect box{20, 10, 200, 180};
    DepthRepair(DepthRepairSettings{mode}).apply(scene.grey, box, scene.depth);
    int between = 0, filled = 0;
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        if (before.at(x, y) > 0.0F) {
          ASSERT_EQ(before.at(x, y), scene.depth.at(x, y));
          continue;
        }
        const float z = scene.depth.at(x, y);
        ++filled;
        between += z > 1.75F && z < 2.6F;
      }
    }
    EXPECT_GT(filled, 3000);
    EXPECT_EQ(between, 0);
  }
}

TEST(DepthRepair, ReuseFillsWhatNoWindowReaches) {
  const Rect box{10, 10, 100, 80};
  RepairScene plain = make_scene(120, 100, 11), reused = make_scene(120, 100, 11);
  for (RepairScene* scene : {&plain, &reused}) {
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 120; ++x) {
        scene->grey.at(x, y) = 90;
        if (x > 60) scene->depth.at(x, y) = 0.0F;
      }
    }
  }
  DepthRepair(DepthRepairSettings{RepairMode::paper}).apply(plain.grey, box, plain.depth);
  DepthRepair(DepthRepairSettings{RepairMode::border}).apply(reused.grey, box, reused.depth);
  EXPECT_GT(share_of_holes(plain.depth, box), 0.3);
  EXPECT_EQ(share_of_holes(reused.depth, box), 0.0);
}

TEST(DepthRepair, ReuseByCellsEndsFarFromWhatWasMeasured) {
  const Rect box{10, 10, 100, 80};
  for (const RepairMode mode : {RepairMode::median, RepairMode::modes}) {
    for (const int farthest : {12, 1000}) {
      RepairScene scene = make_scene(120, 100, 11);
      scene.grey.fill(90);
      for (int y = 0; y < 100; ++y) {
        for (int x = 61; x < 120; ++x) scene.depth.at(x, y) = 0.0F;
      }
      DepthRepairSettings settings{mode};
      settings.farthest = farthest;
      DepthRepair(settings).apply(scene.grey, box, scene.depth);
      for (int y = box.y; y < box.y + box.height; ++y) {
        EXPECT_GT(scene.depth.at(66, y), 0.0F);
        EXPECT_EQ(scene.depth.at(80, y) > 0.0F, farthest > 12);
      }
    }
  }
}

TEST(DepthRepair, LeavesAloneWhatItCannotKnow) {
  for (const RepairMode mode :
       {RepairMode::paper, RepairMode::border, RepairMode::median, RepairMode::modes}) {
    DepthRepair repair(DepthRepairSettings{mode});
    ByteImage grey = ByteImage::filled(50, 40, 77);
    FloatImage depth = FloatImage::filled(50, 40, 0.0F);
    EXPECT_EQ(repair.apply(grey, {5, 5, 30, 30}, depth), 0);   // no depth at all
    EXPECT_EQ(repair.apply(grey, {60, 5, 30, 30}, depth), 0);  // outside
    EXPECT_EQ(repair.apply(grey, {5, 5, 0, 0}, depth), 0);
    depth.fill(std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(repair.apply(grey, {5, 5, 30, 30}, depth), 0);
    depth.fill(1.0F);
    EXPECT_EQ(repair.apply(grey, {0, 0, 50, 40}, depth), 0);  // no hole
    depth.at(20, 20) = -1.0F;
    depth.at(21, 20) = std::numeric_limits<float>::infinity();
    EXPECT_EQ(repair.apply(grey, {0, 0, 50, 40}, depth), 2);
    EXPECT_EQ(depth.at(20, 20), 1.0F);
    depth.at(20, 20) = 0.0F;
    grey.at(20, 20) = 200;  // looks like nothing around it
    EXPECT_EQ(repair.apply(grey, {0, 0, 50, 40}, depth), 0);
  }
}

TEST(DepthRepair, ChangesHolesInsideTheBoxOnly) {
  for (const RepairMode mode :
       {RepairMode::paper, RepairMode::border, RepairMode::median, RepairMode::modes}) {
    RepairScene scene = make_scene(120, 100, 13);
    const FloatImage before = scene.depth.clone();
    const Rect box{40, 20, 50, 60};
    DepthRepair(DepthRepairSettings{mode}).apply(scene.grey, box, scene.depth);
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 120; ++x) {
        if (before.at(x, y) == 0.0F && box.contains(x, y)) continue;
        ASSERT_EQ(before.at(x, y), scene.depth.at(x, y));
      }
    }
  }
}

TEST(DepthRepair, AllocatesNothingAfterTheFirstBox) {
  for (const RepairMode mode :
       {RepairMode::paper, RepairMode::border, RepairMode::median, RepairMode::modes}) {
    DepthRepair repair(DepthRepairSettings{mode});
    RepairScene scene = make_scene(240, 200, 17);
    FloatImage depth = scene.depth.clone();
    repair.apply(scene.grey, {20, 10, 200, 180}, depth);
    depth = scene.depth.clone();
    const std::size_t before = test::allocation_count();
    repair.apply(scene.grey, {20, 10, 200, 180}, depth);
    EXPECT_EQ(test::allocation_count(), before);
  }
}

}  // namespace
}  // namespace penumbra::slam
