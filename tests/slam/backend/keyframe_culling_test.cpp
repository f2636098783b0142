#include "slam/backend/keyframe_culling.h"

#include <gtest/gtest.h>

#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

constexpr double kClose = 1000.0;  // metres: all points count

class KeyframeCulling : public ::testing::Test {
 protected:
  KeyframeCulling() : map(world.camera(), world.scales()), drive(world, map, Vector6d::Zero()) {}

  const test::FeatureWorld world;
  Map map;
  test::DriftingDrive drive;
};

TEST_F(KeyframeCulling, LeavesThreeOthersOfOnePlace) {
  for (int k = 0; k < 9; ++k) drive.add_keyframe(0.0);
  ASSERT_EQ(map.keyframes().size(), 9U);
  EXPECT_EQ(cull_redundant_keyframes(map, 0, kClose, {}), 6);
  ASSERT_EQ(map.keyframes().size(), 3U);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(map.keyframes()[static_cast<std::size_t>(k)]->id, k);
  EXPECT_EQ(cull_redundant_keyframes(map, 0, kClose, {}), 0);
}

TEST_F(KeyframeCulling, LeavesWhatShowsMoreThanOthersDo) {
  // Every keyframe shows what the ones before and behind it do not.
  for (int k = 0; k < 10; ++k) drive.add_keyframe(8.0 * k);
  const std::size_t points = map.points().size();
  EXPECT_EQ(cull_redundant_keyframes(map, 0, kClose, {}), 0);
  EXPECT_EQ(map.points().size(), points);
}

TEST_F(KeyframeCulling, IsOfOneSubmap) {
  for (int k = 0; k < 6; ++k) drive.add_keyframe(0.0);
  drive.begin_submap();
  for (int k = 0; k < 6; ++k) drive.add_keyframe(30.0);
  const int second = map.keyframes().back()->submap;
  EXPECT_EQ(cull_redundant_keyframes(map, second, kClose, {}), 3);
  EXPECT_EQ(map.keyframes().size(), 9U);
  EXPECT_FALSE(map.keyframes()[6]->erased) << "the first of a sub-map stays";
  EXPECT_EQ(map.keyframes()[6]->submap, second);
}

}  // namespace
}  // namespace penumbra::slam
