#include "slam/backend/newcomers.h"

#include <gtest/gtest.h>

#include "slam/backend/local_bundle_adjustment.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// A map of ten keyframes; an adjustment knew the first eight.
class Newcomers : public ::testing::Test {
 protected:
  Newcomers() {
    test::DriftingDrive drive(world, map, Vector6d::Zero());
    for (int k = 0; k < 10; ++k) drive.add_keyframe(k);
    last = map.keyframes()[7];
  }
  // As an adjustment would: the keyframes that it knew are moved, and where they were is remembered.
  void move_known(const SE3& motion) {
    for (KeyFrame* keyframe : map.keyframes()) {
      if (keyframe->id > last->id) continue;
      before[keyframe] = keyframe->T_cw;
      keyframe->T_cw = keyframe->T_cw * motion;
    }
  }
  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  KeyFrame* last = nullptr;
  PosesBefore before;
};

TEST_F(Newcomers, FollowTheirNeighboursWithWhatOnlyTheySee) {
  SE3 motion;
  motion.translation = {0.3, -0.1, 0.2};
  KeyFrame* newest = map.keyframes().back();
  const SE3 from_last = newest->T_cw * last->T_cw.inverse();
  MapPoint* own = nullptr;
  for (MapPoint* point : newest->points) {
    if (point != nullptr && point->observations.front().keyframe == newest) own = point;
  }
  ASSERT_NE(own, nullptr);
  const Eigen::Vector3d seen = newest->T_cw * own->position;
  move_known(motion);
  move_newcomers(map, last->id, before);
  const SE3 now = newest->T_cw * last->T_cw.inverse();
  EXPECT_LT((now.translation - from_last.translation).norm(), 1e-9);
  EXPECT_LT((now.rotation - from_last.rotation).norm(), 1e-9);
  EXPECT_LT((newest->T_cw * own->position - seen).norm(), 1e-9);
}

TEST_F(Newcomers, StayWhereNothingOfTheirsHasMoved) {
  const SE3 T_cw = map.keyframes().back()->T_cw;
  move_newcomers(map, last->id, before);
  EXPECT_EQ(map.keyframes().back()->T_cw.translation, T_cw.translation);
}

TEST_F(Newcomers, AndWhoTheAdjustmentKnewAreToldApart) {
  const SE3 T_cw = last->T_cw;
  move_known(SE3{});
  move_newcomers(map, last->id, before);
  EXPECT_EQ(last->T_cw.translation, T_cw.translation);
  move_newcomers(map, map.keyframes().back()->id, before);
}

TEST_F(Newcomers, LocalAdjustmentInAHurryTakesNothingOutOfTheMap) {
  KeyFrame* centre = map.keyframes().back();
  centre->T_cw.translation.x() += 0.05;
  std::atomic<bool> stop{true};
  const LocalBundleReport hurried = adjust_local_bundle(centre, map, {}, nullptr, &stop);
  EXPECT_TRUE(hurried.stopped);
  EXPECT_EQ(hurried.removed_observations, 0);
  stop = false;
  const LocalBundleReport report = adjust_local_bundle(centre, map, {}, nullptr, &stop);
  EXPECT_FALSE(report.stopped);
  EXPECT_LT((centre->T_cw.inverse().translation - world.T_cw(9).inverse().translation).norm(), 0.02);
}

}  // namespace
}  // namespace penumbra::slam
