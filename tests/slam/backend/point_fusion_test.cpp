#include "slam/backend/point_fusion.h"

#include <gtest/gtest.h>

#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

// Six keyframes; after the third nothing was recognised, so that each point of the world that is seen before
// and after is two points of the map.
class PointFusion : public ::testing::Test {
 protected:
  PointFusion() {
    test::DriftingDrive drive(world, map, Vector6d::Zero());
    for (int k = 0; k < 3; ++k) before = drive.add_keyframe(k);
    drive.forget();
    after = drive.add_keyframe(3.0);
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  KeyFrame *before = nullptr, *after = nullptr;
};

TEST_F(PointFusion, MergesIntoThePointThatMoreKeyframesObserve) {
  const std::vector<MapPoint*> old = before->points, own = after->points;
  const int points = test::count_points(map);
  const int found = fuse_points(map, after, old, 3.0F);
  EXPECT_GT(found, 50);
  EXPECT_EQ(test::count_points(map), points - found) << "each was two";
  int replaced = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i] == nullptr || !own[i]->erased) continue;
    ++replaced;
    ASSERT_EQ(present(own[i]), after->points[i]);
    EXPECT_GE(after->points[i]->observations.size(), 2U);
    EXPECT_GE(observing_feature(*after->points[i], *after), 0);
  }
  EXPECT_GT(replaced, found / 2) << "the old ones have more observations, mostly";
  map.update_covisibility(after);
  EXPECT_FALSE(after->covisibles.empty());
}

TEST_F(PointFusion, KeepsTheGivenPointsWhereTheyAreToStay) {
  const std::vector<MapPoint*> given = after->points;  // with one observation each
  EXPECT_GT(fuse_points(map, before, given, 3.0F, /*keep_given=*/true), 50);
  for (const MapPoint* point : given) {
    EXPECT_TRUE(point == nullptr || !point->erased);
  }
}

TEST_F(PointFusion, ObservesAPointWhereTheFeatureShowsNone) {
  for (MapPoint* point : std::vector<MapPoint*>(after->points)) {
    if (point != nullptr) map.erase_point(point);
  }
  ASSERT_EQ(test::count_points(*after), 0);
  const int found = fuse_points(map, after, before->points, 3.0F);
  EXPECT_GT(found, 50);
  EXPECT_EQ(test::count_points(*after), found);
}

TEST_F(PointFusion, SkipsWhatIsNoPointAndWhatIsNotSeen) {
  MapPoint* erased = before->points[0] != nullptr ? before->points[0] : before->points[1];
  map.erase_point(erased);
  EXPECT_EQ(fuse_points(map, after, {nullptr, erased}, 3.0F), 0);
  EXPECT_EQ(fuse_points(map, after, {}, 3.0F), 0);
  EXPECT_EQ(fuse_points(map, before, before->points, 3.0F), 0) << "all are observed there";
  std::vector<int> seen;
  const SE3 away = world.T_cw(50.0);
  KeyFrame* elsewhere = map.add_keyframe(9, 0.9, away, world.view(away, 5, seen));
  EXPECT_EQ(fuse_points(map, elsewhere, before->points, 3.0F), 0);
}

}  // namespace
}  // namespace penumbra::slam
