#include "slam/dynamics/rgbd/object_in_box.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"
#include "tests/support/allocation_counter.h"

namespace penumbra::slam {
namespace {

constexpr int kBoxesWidth = 320, kBoxesHeight = 240;
constexpr double kFocal = 260.0;

struct BoxesScene {
  ByteImage image = ByteImage::filled(kBoxesWidth, kBoxesHeight, 120);
  FloatImage depth = FloatImage::filled(kBoxesWidth, kBoxesHeight, 4.0F);

  void fill(const Rect& area, float metres, std::uint8_t grey) {
    for (int y = area.y; y < area.y + area.height; ++y) {
      for (int x = area.x; x < area.x + area.width; ++x) {
        depth.at(x, y) = metres;
        image.at(x, y) = grey;
      }
    }
  }
  void add_noise() {
    for (int n = 0; n < kBoxesWidth * kBoxesHeight; ++n) {
      float& z = depth.data()[n];
      z += 0.002F * z * z * static_cast<float>(counter_uniform(3, static_cast<std::uint64_t>(n)) - 0.5);
    }
  }
};

// A head on a body, 0.5 m wide, 2 m away.
const Rect kHead{142, 40, 36, 40}, kBody{120, 80, 80, 120};
const Rect kBox{120, 40, 80, 160};

BoxesScene person() {
  BoxesScene scene;
  scene.fill(kHead, 2.0F, 200);
  scene.fill(kBody, 2.05F, 60);
  return scene;
}

double iou(const ObjectMask& found, const Rect& box, const std::vector<Rect>& truth) {
  int shared = 0, joint = 0;
  for (int y = 0; y < box.height; ++y) {
    for (int x = 0; x < box.width; ++x) {
      bool is_object = false;
      for (const Rect& part : truth) is_object = is_object || part.contains(box.x + x, box.y + y);
      const bool inside = found.mask.at(x, y) != 0;
      shared += inside && is_object;
      joint += inside || is_object;
    }
  }
  return shared / static_cast<double>(joint);
}

ObjectMask find(const BoxesScene& scene, const Rect& box, const ObjectInBoxSettings& settings = {}) {
  ObjectInBox finder(kFocal, settings);
  ObjectMask found;
  finder.find(scene.image, scene.depth, box, {}, found);
  EXPECT_EQ(found.mask.size(), (Size{box.width, box.height}));
  return found;
}

TEST(ObjectInBox, FindsWhatStandsOut) {
  BoxesScene scene = person();
  scene.add_noise();
  const ObjectMask found = find(scene, kBox);
  EXPECT_GT(iou(found, kBox, {kHead, kBody}), 0.97);
  EXPECT_NEAR(found.depth, 2.04, 0.05);
}

TEST(ObjectInBox, LeavesOutADeskInFrontAndOneBeside) {
  BoxesScene scene = person();
  scene.fill({0, 150, kBoxesWidth, 90}, 1.4F, 150);  // hides a third of the box, and goes on outside
  scene.fill({0, 120, 118, 30}, 2.0F, 90);           // at the person's depth
  scene.fill({202, 120, 118, 30}, 2.0F, 90);
  scene.add_noise();
  const Rect box{110, 40, 100, 160};
  const Rect body{kBody.x, kBody.y, kBody.width, 70};
  EXPECT_GT(iou(find(scene, box), box, {kHead, body}), 0.9);
}

TEST(ObjectInBox, FindsWhatTheBorderCuts) {
  BoxesScene scene;
  const Rect part{0, 60, 40, 180};
  scene.fill(part, 1.5F, 70);
  scene.add_noise();
  EXPECT_GT(iou(find(scene, part), part, {part}), 0.97);
  const Rect wide{0, 60, 70, 180};
  EXPECT_GT(iou(find(scene, wide), wide, {part}), 0.9);
}

TEST(ObjectInBox, KeepsTheBoxWhereNothingStandsOut) {
  BoxesScene flat;  // a keyboard on a desk, seen along it
  for (int y = 0; y < kBoxesHeight; ++y) {
    for (int x = 0; x < kBoxesWidth; ++x) flat.depth.at(x, y) = 3.0F - 0.006F * static_cast<float>(y);
  }
  const Rect box{130, 150, 60, 30};
  const ObjectMask found = find(flat, box);
  EXPECT_GT(iou(found, box, {box}), 0.8);

  BoxesScene blind;
  blind.depth.fill(0.0F);
  EXPECT_EQ(iou(find(blind, box), box, {box}), 1.0);
  EXPECT_EQ(find(blind, box).depth, 0.0);
  blind.depth.fill(NAN);
  EXPECT_EQ(iou(find(blind, box), box, {box}), 1.0);
}

TEST(ObjectInBox, TakesBoxesOfAnySize) {
  BoxesScene scene = person();
  scene.add_noise();
  for (const Rect& box : {Rect{0, 0, 1, 1}, Rect{319, 239, 1, 1}, Rect{5, 5, 3, 100}, Rect{0, 0, 320, 240},
                          Rect{150, 0, 2, 240}}) {
    for (const ClusterMode mode : {ClusterMode::paper, ClusterMode::grown}) {
      for (const int clusters : {1, 2, 3, 8, 16}) {
        ObjectInBoxSettings settings;
        settings.mode = mode;
        settings.clusters = clusters;
        find(scene, box, settings);
      }
    }
  }
}

// Equations 4 and 5 with two clusters, a share s of the pixels at 2 m and the rest at 4 m:
// score(2 m) = s / (2 |1 - 2 s|) - 1/2,  score(4 m) = (1 - s) / (2 |1 - 2 s|) - 1. For s < 1/2 they are
// equal.
TEST(ObjectInBox, ThePaperTiesWithTwoClusters) {
  ObjectInBoxSettings settings;
  settings.mode = ClusterMode::paper;
  settings.clusters = 2;
  BoxesScene scene;
  const Rect box{100, 100, 100, 100};
  const auto found_depth = [&](int columns) {
    scene.depth.fill(4.0F);
    scene.fill({100, 100, columns, 100}, 2.0F, 100);
    return find(scene, box, settings).depth;
  };
  // Ties go to the nearest; at 50 the counts are equal, and their denominator is 0.
  for (const int columns : {26, 40, 50, 60, 70}) EXPECT_NEAR(found_depth(columns), 2.0, 1e-3) << columns;
  scene.depth.fill(4.0F);  // one cluster: both denominators are 0
  EXPECT_EQ(iou(find(scene, box, settings), box, {box}), 1.0);
}

// The letter's own weakness: one cluster is a slice of a person who leans.
TEST(ObjectInBox, ThePaperTakesOneCluster) {
  BoxesScene scene;
  for (int row = 0; row < 160; ++row)
    scene.fill({120, 40 + row, 60, 1}, 1.8F + 0.002F * static_cast<float>(row), 60);
  scene.add_noise();
  const Rect person{120, 40, 60, 160};
  ObjectInBoxSettings settings;
  EXPECT_GT(iou(find(scene, kBox, settings), kBox, {person}), 0.95);
  settings.mode = ClusterMode::paper;
  settings.clusters = 3;
  EXPECT_LT(iou(find(scene, kBox, settings), kBox, {person}), 0.7);
}

TEST(ObjectInBox, AllocatesNothingAfterTheFirstBox) {
  for (const ClusterMode mode : {ClusterMode::paper, ClusterMode::grown}) {
    BoxesScene scene = person();
    scene.add_noise();
    ObjectInBoxSettings settings;
    settings.mode = mode;
    ObjectInBox finder(kFocal, settings);
    ObjectMask found;
    finder.find(scene.image, scene.depth, kBox, {}, found);
    const std::size_t before = test::allocation_count();
    finder.find(scene.image, scene.depth, kBox, {}, found);
    EXPECT_EQ(test::allocation_count(), before);
  }
}

}  // namespace
}  // namespace penumbra::slam
