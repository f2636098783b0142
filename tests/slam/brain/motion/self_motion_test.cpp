#include "slam/brain/motion/self_motion.h"

#include <gtest/gtest.h>

#include <numbers>

namespace penumbra::slam::brain {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(PlanePose, AQuarterTurnToTheLeftMakesForwardLeft) {
  const PlanePose a{1.0, 2.0, kPi / 2.0};
  const PlanePose b = a * PlanePose{3.0, 0.0, 0.0};
  EXPECT_NEAR(b.x, 1.0, 1e-12);
  EXPECT_NEAR(b.y, 5.0, 1e-12);
  EXPECT_NEAR(b.heading, kPi / 2.0, 1e-12);
}

TEST(PlanePose, ItsInverseLeadsBack) {
  for (const PlanePose& a : {PlanePose{1.0, -2.0, 0.7}, PlanePose{-30.0, 4.0, -3.1}, PlanePose{}}) {
    const PlanePose none = a * a.inverse();
    EXPECT_NEAR(none.distance(), 0.0, 1e-12);
    EXPECT_NEAR(none.heading, 0.0, 1e-12);
  }
}

TEST(PlanePose, IsACamerasPoseAndBack) {
  for (const double heading : {0.0, 0.4, -2.9, 3.1}) {
    const PlanePose a{4.0, -7.0, heading};
    const PlanePose b = plane_pose(camera_pose(a));
    EXPECT_NEAR(b.x, a.x, 1e-12);
    EXPECT_NEAR(b.y, a.y, 1e-12);
    EXPECT_NEAR(b.heading, a.heading, 1e-12);
  }
}

TEST(PlanePose, ComposesAsCamerasDo) {
  const PlanePose a{1.0, 2.0, 0.5}, b{-3.0, 0.4, 1.9};
  const SE3 both = camera_pose(a) * camera_pose(b);
  EXPECT_NEAR((both.translation - camera_pose(a * b).translation).norm(), 0.0, 1e-12);
  EXPECT_NEAR((both.rotation - camera_pose(a * b).rotation).norm(), 0.0, 1e-12);
}

TEST(PlanePose, ACameraThatLooksStraightDownHasAHeading) {
  SE3 T;
  T.rotation = Eigen::AngleAxisd(-kPi / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_TRUE(plane_pose(T).is_finite());
}

TEST(SelfMotion, GoesRoundACircleAndComesBack) {
  PlanePose pose;
  for (int i = 0; i < 36; ++i) pose = pose * step_of({2.0, kPi / 18.0, 1.0});
  EXPECT_NEAR(pose.distance(), 0.0, 1e-9);
  EXPECT_NEAR(pose.heading, 0.0, 1e-9);
}

TEST(SelfMotion, IsWhatLeadsToAStep) {
  for (const double turn : {0.0, 1e-9, 0.3, -2.0}) {
    const SelfMotion motion{5.0, turn, 0.1};
    const SelfMotion again = motion_of(step_of(motion), 0.1);
    EXPECT_NEAR(again.speed, motion.speed, 1e-9);
    EXPECT_NEAR(again.turn_rate, motion.turn_rate, 1e-9);
  }
  EXPECT_LT(motion_of({-1.0, 0.0, 0.1}, 0.5).speed, 0.0) << "backward";
}

}  // namespace
}  // namespace penumbra::slam::brain
