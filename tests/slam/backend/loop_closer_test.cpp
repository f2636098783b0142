#include "slam/backend/loop_closer.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

constexpr int kLap = test::FeatureWorld::kKeyframesPerLap;

// Turns too far by `degrees` a lap.
Vector6d drift(double degrees) {
  Vector6d drift = Vector6d::Zero();
  drift[4] = degrees * std::numbers::pi / 180.0 / kLap;
  return drift;
}

// A drive round the ring road, with loop closing.
class RingRoad : public ::testing::Test {
 protected:
  void drive_on(test::DriftingDrive& drive, double from, double to) {
    for (double steps = from; steps < to; steps += 1.0) {
      const auto closed = closer.process(drive.add_keyframe(steps));
      steps_of.push_back(steps);
      if (closed) closed_at.push_back(steps);
    }
  }
  // The largest distance of a keyframe from where it truly is.
  double largest_error() const {
    double largest = 0.0;
    for (const KeyFrame* k : map.keyframes()) {
      const SE3 truth = world.T_cw(steps_of[static_cast<std::size_t>(k->id)]);
      largest = std::max(largest, (k->T_cw.inverse().translation - truth.inverse().translation).norm());
    }
    return largest;
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  PlaceIndex index;
  LoopCloser closer{map, index, {}};
  std::vector<double> steps_of, closed_at;
};

TEST_F(RingRoad, IsClosedWhereItBegan) {
  test::DriftingDrive drive(world, map, drift(6.0));
  drive_on(drive, 0.0, kLap - 10.0);
  const double before = largest_error();
  EXPECT_GT(before, 1.0);
  EXPECT_TRUE(closed_at.empty());
  drive_on(drive, kLap - 10.0, kLap + 6.0);
  ASSERT_EQ(closer.loops().size(), 1U);
  const ClosedLoop& loop = closer.loops().front();
  EXPECT_LE(closed_at.front(), kLap + 4.0);
  EXPECT_NEAR(loop.frame - loop.earlier_frame, kLap, 6);
  EXPECT_GT(loop.correction_metres, 0.5);
  EXPECT_FALSE(loop.merged_submaps);
  // Even drift is shared out evenly, the little that came after the loop remains.
  EXPECT_LT(largest_error(), 0.25 * before);
  // Both visits see the same points now.
  const KeyFrame* second = map.keyframes()[static_cast<std::size_t>(loop.frame)];
  int older = 0;
  for (const Covisible& c : second->covisibles) older += c.keyframe->id < 20;
  EXPECT_GE(older, 1);
}

// The camera where the road begins, turned by `degrees`.
SE3 turned(double degrees) {
  const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
  return SE3{turn.toRotationMatrix(), Eigen::Vector3d::Zero()}.inverse();
}

TEST_F(RingRoad, IsClosedByACameraThatTurnsOnTheSpot) {
  test::DriftingDrive drive(world, map, drift(6.0));
  for (int k = 0; k < kLap + 6; ++k) closer.process(drive.add_keyframe(turned(360.0 * k / kLap)));
  ASSERT_EQ(closer.loops().size(), 1U);
  // All keyframes are equally near; the earlier one looks at most 30 degrees elsewhere.
  EXPECT_NEAR(closer.loops().front().frame - closer.loops().front().earlier_frame, kLap, 30.0 * kLap / 360.0);
}

// It sees one place as often as one likes, but only once: were it the wrong one, nothing would contradict it.
TEST_F(RingRoad, IsNotClosedByACameraThatStands) {
  test::DriftingDrive drive(world, map, drift(6.0));
  for (int k = 0; k < kLap / 2; ++k) closer.process(drive.add_keyframe(turned(360.0 * k / kLap)));
  drive.forget();
  for (int k = 0; k < 12; ++k) closer.process(drive.add_keyframe(turned(0.5 * (k % 2))));
  EXPECT_GE(closer.recognised().size(), 5U);
  EXPECT_TRUE(closer.loops().empty());
}

TEST_F(RingRoad, IsNotClosedWithoutARevisit) {
  test::DriftingDrive drive(world, map, drift(6.0));
  drive_on(drive, 0.0, 0.8 * kLap);
  EXPECT_TRUE(closer.loops().empty());
}

// The same place seen again and again, further from where odometry has it than drift can be.
TEST_F(RingRoad, RefusesACorrectionThatDriftCannotExplain) {
  test::DriftingDrive drive(world, map, drift(60.0));
  drive_on(drive, 0.0, kLap + 8.0);
  EXPECT_TRUE(closer.loops().empty());
}

TEST_F(RingRoad, MergesASubmapThatComesToAKnownPlace) {
  test::DriftingDrive first(world, map, Vector6d::Zero());
  drive_on(first, 0.0, 30.0);
  // Lost; goes on elsewhere, with a wrong idea of where it is: everything is a quarter lap off.
  first.begin_submap();
  Vector6d guess = Vector6d::Zero();
  guess << 3.0, 0.0, 5.0, 0.0, 0.4, 0.0;
  first.shift(guess);
  drive_on(first, 60.0, kLap + 4.0);
  ASSERT_EQ(closer.loops().size(), 1U);
  EXPECT_TRUE(closer.loops().front().merged_submaps);
  for (const KeyFrame* k : map.keyframes()) EXPECT_EQ(k->submap, 0);
  EXPECT_LT(largest_error(), 0.1);
}

TEST_F(RingRoad, RecognisesAMapThatWasLoaded) {
  test::DriftingDrive old_drive(world, map, Vector6d::Zero());
  for (int k = 0; k < kLap; ++k) {
    old_drive.add_keyframe(k);
    steps_of.push_back(k);
  }
  closer.adopt_map();
  EXPECT_EQ(index.keyframes(), kLap);
  old_drive.begin_submap();
  Vector6d guess = Vector6d::Zero();
  guess << 3.0, 0.0, 5.0, 0.0, 0.4, 0.0;
  old_drive.shift(guess);
  drive_on(old_drive, 40.0, 52.0);
  ASSERT_EQ(closer.loops().size(), 1U);
  EXPECT_TRUE(closer.loops().front().merged_submaps);
  EXPECT_LT(largest_error(), 0.1);
}

TEST_F(RingRoad, RepeatsBitForBit) {
  test::DriftingDrive drive(world, map, drift(6.0));
  drive_on(drive, 0.0, kLap + 8.0);
  Map map2(world.camera(), world.scales());
  PlaceIndex index2;
  LoopCloser closer2(map2, index2, {});
  test::DriftingDrive drive2(world, map2, drift(6.0));
  for (int k = 0; k < kLap + 8; ++k) closer2.process(drive2.add_keyframe(k));
  ASSERT_EQ(map.keyframes().size(), map2.keyframes().size());
  for (std::size_t k = 0; k < map.keyframes().size(); ++k) {
    EXPECT_EQ(map.keyframes()[k]->T_cw.translation, map2.keyframes()[k]->T_cw.translation);
  }
}

TEST_F(RingRoad, WithoutLoopsStillRemembersPlaces) {
  LoopCloserSettings settings;
  settings.enabled = false;
  LoopCloser off(map, index, settings);
  test::DriftingDrive drive(world, map, drift(6.0));
  for (int k = 0; k < kLap + 8; ++k) EXPECT_FALSE(off.process(drive.add_keyframe(k)));
  EXPECT_GT(index.keyframes(), kLap - 10);
}

}  // namespace
}  // namespace penumbra::slam
