#include "slam/frontend/locating/by_motion.h"

#include "tests/slam/frontend/locating/locating_scene.h"

namespace penumbra::slam {
namespace {

using ByMotion = test::LocatingScene;

TEST_F(ByMotion, FindsTheFrameWhereTheMotionLeads) {
  const SE3 truth = world.T_cw(10.5);
  const Frame frame = frame_at(truth);
  locate_by_motion(input(frame, world.T_cw(10.45)), found, spare);
  ASSERT_TRUE(found.success);
  EXPECT_FALSE(found.off_map);
  EXPECT_LT(error(found, truth), 0.03);
  EXPECT_GT(found.pairs(), 50);
  EXPECT_GT(found.inliers, 50);
  EXPECT_GE(static_cast<int>(found.looked_for.size()), found.inliers);
  EXPECT_EQ(found.inliers,
            std::count_if(found.points.begin(), found.points.end(), [](auto* p) { return p != nullptr; }));
  ASSERT_NE(found.reference, nullptr);
  EXPECT_NEAR(found.reference->id, 10, 3);
}

// The prediction is off by more than the narrow window of the fine levels, and less than the wide one.
TEST_F(ByMotion, LooksInAWiderWindowWhereTheNarrowOneShowsLittle) {
  const SE3 truth = world.T_cw(10.5);
  const Frame frame = frame_at(truth);
  Vector6d turn = Vector6d::Zero();
  turn[4] = 20.0 / world.camera().fx;
  const LocatingInput in = input(frame, SE3::exp(turn) * truth);
  locate_by_motion(in, found, spare);
  ASSERT_TRUE(found.success);
  EXPECT_LT(error(found, truth), 0.03);
  const int pairs = found.pairs();
  settings.wide_search_radius = settings.search_radius;
  locate_by_motion(in, found, spare);
  EXPECT_LT(found.pairs(), pairs / 2);
}

TEST_F(ByMotion, FindsNothingWhereTheFrameIsNotOrShowsNothing) {
  const Frame elsewhere = frame_at(world.T_cw(60.0));
  locate_by_motion(input(elsewhere, world.T_cw(10.5)), found, spare);
  EXPECT_FALSE(found.success);
  Frame dark = frame_at(world.T_cw(10.5));
  dark.features = std::make_shared<FrameFeatures>();
  dark.movable.clear();
  locate_by_motion(input(dark, world.T_cw(10.5)), found, spare);
  EXPECT_FALSE(found.success);
  EXPECT_EQ(found.pairs(), 0);
}

TEST_F(ByMotion, DependsOnWhatIsKnownAloneAndChangesNothingOfIt) {
  const Frame frame = frame_at(world.T_cw(10.5));
  const LocatingInput in = input(frame, world.T_cw(10.3));
  const FrameFeatures before = *frame.features;
  locate_by_motion(in, found, spare);
  Hypothesis again;
  locate_by_motion(in, again, spare);
  EXPECT_EQ(found.points, again.points);
  EXPECT_EQ(found.T_cw.translation, again.T_cw.translation);
  EXPECT_EQ(found.T_cw.rotation, again.T_cw.rotation);
  EXPECT_EQ(frame.features->u_right, before.u_right);
  for (int i = 0; i < before.size(); ++i) {
    EXPECT_EQ(frame.features->keypoint(i).u, before.keypoint(i).u);
    EXPECT_EQ(frame.features->keypoint(i).v, before.keypoint(i).v);
  }
}

TEST_F(ByMotion, LeavesOutWhatMoves) {
  Frame frame = frame_at(world.T_cw(10.5));
  for (std::size_t i = 0; i < frame.movable.size(); i += 3) frame.movable[i] = 1;
  locate_by_motion(input(frame, world.T_cw(10.45)), found, spare);
  ASSERT_TRUE(found.success);
  for (std::size_t i = 0; i < found.points.size(); i += 3) EXPECT_EQ(found.points[i], nullptr);
}

// The map knows too little here, the last frame enough.
TEST_F(ByMotion, LeavesTheMapOnlyWhereItMay) {
  settings.fewest_map_inliers = 1000000;
  const SE3 truth = world.T_cw(10.5);
  const Frame frame = frame_at(truth);
  const LocatingInput in = input(frame, truth);
  locate_around(in, truth, /*may_leave_map=*/false, found, spare);
  EXPECT_FALSE(found.success);
  locate_around(in, truth, /*may_leave_map=*/true, found, spare);
  ASSERT_TRUE(found.success);
  EXPECT_TRUE(found.off_map);
  EXPECT_EQ(found.inliers, found.pairs());
  EXPECT_LT(error(found, truth), 0.1);
  settings.extends_map = false;  // nobody would make the points that are missing
  locate_around(in, truth, /*may_leave_map=*/true, found, spare);
  EXPECT_FALSE(found.success);
}

}  // namespace
}  // namespace penumbra::slam
