#include "slam/backend/local_mapper.h"

#include <gtest/gtest.h>

#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

class LocalMapperTest : public ::testing::Test {
 protected:
  KeyFrame* insert(double steps) {
    MapWork work = drive.next(steps);
    if (give_patches)
      work.keyframe->patches = std::make_shared<const std::vector<Patch>>(work.tracked.size());
    KeyFrame* keyframe = map.insert_keyframe(std::move(work.keyframe));
    mapper.insert(keyframe, work.tracked, work.aligned);
    drive.learn(*keyframe);
    return keyframe;
  }
  KeyFrame* add(double steps) {
    KeyFrame* keyframe = insert(steps);
    mapper.process(keyframe);
    return keyframe;
  }
  double error(const KeyFrame& keyframe, double steps) const {
    return (keyframe.T_cw.inverse().translation - world.T_cw(steps).inverse().translation).norm();
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  LocalMapperSettings settings;
  LocalMapper mapper{map, settings};
  test::MappedDrive drive{world, map};
  bool give_patches = false;
};

TEST_F(LocalMapperTest, ConnectsAKeyframeAndMakesPointsOfWhatIsNew) {
  const KeyFrame* first = insert(0.0);
  EXPECT_EQ(test::count_points(*first), first->features->size());
  EXPECT_TRUE(first->covisibles.empty());
  const int before = test::count_points(map);
  const KeyFrame* second = insert(1.0);
  EXPECT_EQ(test::count_points(*second), second->features->size());
  ASSERT_FALSE(second->covisibles.empty());
  EXPECT_EQ(second->covisibles.front().keyframe, first);
  EXPECT_EQ(test::count_points(map),
            before + second->features->size() - second->covisibles.front().shared_points);
}

TEST_F(LocalMapperTest, PutsAPoseRightThatWasALittleOff) {
  for (int k = 0; k < 6; ++k) add(k);
  KeyFrame* newest = insert(6.0);
  Vector6d motion = Vector6d::Zero();
  motion.head<3>() = Eigen::Vector3d(0.03, -0.02, 0.04);
  newest->T_cw = SE3::exp(motion) * newest->T_cw;
  ASSERT_GT(error(*newest, 6.0), 0.04);
  mapper.process(newest);
  EXPECT_LT(error(*newest, 6.0), 0.02);
}

TEST_F(LocalMapperTest, TakesRecentPointsAwayThatAreSeldomFound) {
  for (int k = 0; k < 3; ++k) add(k);
  KeyFrame* newest = insert(3.0);
  MapPoint* bad = nullptr;
  for (MapPoint* point : newest->points) {
    if (point != nullptr && point->first_keyframe == newest->id) bad = point;
  }
  ASSERT_NE(bad, nullptr);
  bad->visible = 100;
  bad->found = 10;
  mapper.process(newest);
  EXPECT_TRUE(bad->erased);
}

// Forty keyframes within two metres show the same again and again.
TEST_F(LocalMapperTest, TakesRedundantKeyframesAwayButNotTheFirst) {
  for (int k = 0; k < 40; ++k) add(0.05 * k);
  EXPECT_LT(map.keyframes().size(), 25U);
  EXPECT_EQ(map.keyframes().front()->id, 0);
  for (const KeyFrame* keyframe : map.keyframes()) EXPECT_LT(error(*keyframe, 0.05 * keyframe->id), 0.05);
}

TEST_F(LocalMapperTest, GivesPatchesToThePointsAndLetsGoOfThem) {
  give_patches = true;
  const KeyFrame* keyframe = insert(0.0);
  EXPECT_NE(keyframe->patches, nullptr);
  const MapPoint* point = keyframe->points.front();
  ASSERT_NE(point, nullptr);
  EXPECT_NEAR(point->patch_depth, (keyframe->T_cw * point->position).z(), 1e-9);
  mapper.process(map.keyframes().front());
  EXPECT_EQ(keyframe->patches, nullptr);
}

TEST_F(LocalMapperTest, TakesAKeyframeThatShowsNothing) {
  add(0.0);
  KeyFrame* empty = map.add_keyframe(1, 0.1, world.T_cw(1.0), std::make_shared<FrameFeatures>());
  mapper.insert(empty, {}, {});
  mapper.process(empty);
  EXPECT_TRUE(empty->covisibles.empty());
  EXPECT_EQ(map.keyframes().size(), 2U);
}

}  // namespace
}  // namespace penumbra::slam
