#include "slam/backend/point_creation.h"

#include <gtest/gtest.h>

#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

class PointCreation : public ::testing::Test {
 protected:
  KeyFrame* keyframe_at(double steps) {
    const SE3 T_cw = world.T_cw(steps);
    return map.add_keyframe(0, 0.0, T_cw, world.view(T_cw, 1, seen));
  }
  // Metres between the map's point and the world's that feature `i` shows.
  double error(const KeyFrame& keyframe, std::size_t i) const {
    return (keyframe.points[i]->position - world.point(seen[i])).norm();
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  PointCreationSettings settings;
  std::vector<int> seen;
};

TEST_F(PointCreation, MakesAPointOfEveryCloseFeatureWithDepth) {
  KeyFrame* keyframe = keyframe_at(3.0);
  keyframe->movable[7] = 1;
  const int created = create_stereo_points(keyframe, map, settings);
  EXPECT_EQ(created, keyframe->features->size() - 1);
  EXPECT_EQ(keyframe->points[7], nullptr) << "it moves";
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    if (i == 7) continue;
    ASSERT_NE(keyframe->points[i], nullptr);
    const double z = keyframe->features->depth[i];
    EXPECT_LT(error(*keyframe, i), 0.05 + 0.006 * z * z) << i;
    EXPECT_TRUE(keyframe->aligned[i]) << "by definition it is where the feature is";
  }
  EXPECT_EQ(create_stereo_points(keyframe, map, settings), 0) << "all show one already";
}

TEST_F(PointCreation, TrustsFarStereoOnlyWhereThereIsTooLittle) {
  KeyFrame* keyframe = keyframe_at(3.0);
  settings.close_baselines = 0.0;
  settings.fewest_stereo_points = 10;
  EXPECT_EQ(create_stereo_points(keyframe, map, settings), 10);
  float farthest = 0.0F, nearest_left = 1e9F;
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    const float z = keyframe->features->depth[i];
    if (keyframe->points[i] != nullptr) farthest = std::max(farthest, z);
    if (keyframe->points[i] == nullptr) nearest_left = std::min(nearest_left, z);
  }
  EXPECT_LE(farthest, nearest_left) << "the nearest ones";
}

// A camera with one eye that has gone on by two steps.
TEST_F(PointCreation, TriangulatesWhatTwoKeyframesShow) {
  test::DriftingDrive drive(world, map, Vector6d::Zero());
  for (int k = 0; k < 3; ++k) drive.add_keyframe(k);
  KeyFrame* newest = map.keyframes().back();
  world.view(world.T_cw(2.0), 1002, seen);  // as the drive saw it
  ASSERT_EQ(seen.size(), newest->points.size());
  // Every other point goes: its features are free again.
  int free = 0;
  for (const auto& point : map.points()) {
    if (point->id % 2 == 0) continue;
    free += observing_feature(*point, *newest) >= 0;
    map.erase_point(point.get());
  }
  ASSERT_GT(free, 40);
  const int before = test::count_points(map);
  const int created = triangulate_with_neighbours(newest, map, settings);
  EXPECT_GT(created, free / 4);
  EXPECT_EQ(test::count_points(map), before + created);
  int good = 0, all = 0;
  for (std::size_t i = 0; i < newest->points.size(); ++i) {
    const MapPoint* point = newest->points[i];
    if (point == nullptr || point->first_keyframe != newest->id || point->observations.size() < 2) continue;
    ++all;
    good += error(*newest, i) < 0.05 + 0.006 * std::pow(newest->features->depth[i], 2);
  }
  EXPECT_GE(good, 9 * all / 10);
}

TEST_F(PointCreation, MakesNothingOfNothing) {
  KeyFrame* empty = map.add_keyframe(0, 0.0, SE3{}, std::make_shared<FrameFeatures>());
  EXPECT_EQ(create_stereo_points(empty, map, settings), 0);
  EXPECT_EQ(triangulate_with_neighbours(empty, map, settings), 0);
  KeyFrame* alone = keyframe_at(3.0);
  EXPECT_EQ(triangulate_with_neighbours(alone, map, settings), 0) << "no neighbour";
}

}  // namespace
}  // namespace penumbra::slam
