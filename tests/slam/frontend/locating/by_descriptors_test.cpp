#include "slam/frontend/locating/by_descriptors.h"

#include "tests/slam/frontend/locating/locating_scene.h"

namespace penumbra::slam {
namespace {

using ByDescriptors = test::LocatingScene;

// Three metres ahead and turned: far outside every window around the last pose.
TEST_F(ByDescriptors, FindsTheFrameWithoutAPrediction) {
  const SE3 truth = world.T_cw(13.0);
  const Frame frame = frame_at(truth);
  LocatingInput in = input(frame, world.T_cw(10.0));
  in.motion_known = false;
  const std::optional<SE3> rough = pose_by_descriptors(in);
  ASSERT_TRUE(rough);
  EXPECT_LT((*rough * truth.inverse()).translation.norm(), 0.5);
  locate_by_descriptors(in, rough, found, spare);
  ASSERT_TRUE(found.success);
  EXPECT_LT(error(found, truth), 0.03);
}

TEST_F(ByDescriptors, DrawsTheSameForTheSameFrame) {
  const Frame frame = frame_at(world.T_cw(12.0));
  const LocatingInput in = input(frame, world.T_cw(10.0));
  const std::optional<SE3> a = pose_by_descriptors(in), b = pose_by_descriptors(in);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->translation, b->translation);
  EXPECT_EQ(a->rotation, b->rotation);
}

TEST_F(ByDescriptors, FindsNothingInAnotherPlaceOrWithoutFeatures) {
  const Frame elsewhere = frame_at(world.T_cw(60.0));
  EXPECT_FALSE(pose_by_descriptors(input(elsewhere, world.T_cw(10.0))));
  Frame dark = frame_at(world.T_cw(10.0));
  dark.features = std::make_shared<FrameFeatures>();
  dark.movable.clear();
  EXPECT_FALSE(pose_by_descriptors(input(dark, world.T_cw(10.0))));
}

TEST_F(ByDescriptors, WithoutARoughPoseGoesByTheMotionIfThereIsOne) {
  const SE3 truth = world.T_cw(10.5);
  const Frame frame = frame_at(truth);
  LocatingInput in = input(frame, world.T_cw(10.45));
  locate_by_descriptors(in, std::nullopt, found, spare);
  EXPECT_TRUE(found.success);
  in.motion_known = false;
  locate_by_descriptors(in, std::nullopt, found, spare);
  EXPECT_FALSE(found.success);
}

// What RANSAC has found may leave the map, but not where the view is covered.
TEST_F(ByDescriptors, LeavesTheMapWhereNothingCoversTheView) {
  settings.fewest_map_inliers = 1000000;
  const SE3 truth = world.T_cw(12.0);
  const Frame frame = frame_at(truth);
  LocatingInput in = input(frame, world.T_cw(10.0));
  locate_by_descriptors(in, pose_by_descriptors(in), found, spare);
  ASSERT_TRUE(found.success);
  EXPECT_TRUE(found.off_map);
  in.prior = PosePrior{truth, 0.1, 0.02};
  locate_by_descriptors(in, truth, found, spare);
  EXPECT_FALSE(found.success);
}

}  // namespace
}  // namespace penumbra::slam
