#include "slam/brain/motion/camera_mount.h"

#include <gtest/gtest.h>

#include <numbers>

#include "slam/brain/motion/plane.h"

namespace penumbra::slam::brain {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A robot that drives a circle to the left, seen by a camera that is turned on it.
Trajectory circle(const CameraMount& mount, int frames = 200) {
  Trajectory path;
  for (int i = 0; i < frames; ++i) {
    const double angle = 0.03 * i;
    const PlanePose robot{5.0 * std::sin(angle), 5.0 * (1.0 - std::cos(angle)), wrapped_angle(angle)};
    path.push_back({0.1 * i, mount.to_camera(camera_pose(robot))});
  }
  return path;
}

TEST(CameraMount, ByHandACameraThatLooksLeftSeesTheWayToItsRight) {
  const CameraMount mount(90.0 * kDegree, 0.0);
  SE3 step;
  step.translation = {0.5, 0.0, 0.0};
  EXPECT_NEAR((mount.to_robot(step).translation - Eigen::Vector3d(0.0, 0.0, 0.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((mount.to_camera(mount.to_robot(step)).translation - step.translation).norm(), 0.0, 1e-12);
}

TEST(CameraMount, ByHandACameraThatLooksDownSeesTheWayRise) {
  // At 30 degrees a metre ahead is cos 30 along the view and half a metre up in the image.
  SE3 ahead;
  ahead.translation = {0.0, 0.0, 1.0};
  const Eigen::Vector3d seen = CameraMount(0.0, 30.0 * kDegree).to_camera(ahead).translation;
  EXPECT_NEAR(seen.y(), -0.5, 1e-12);
  EXPECT_NEAR(seen.z(), std::cos(30.0 * kDegree), 1e-12);
}

TEST(CameraMount, IsFoundInAPath) {
  for (const auto& [yaw, pitch] : {std::pair(90.0, 0.0), {0.0, 20.0}, {-60.0, 10.0}, {180.0, 0.0}}) {
    const CameraMount found = CameraMount::of_path(circle({yaw * kDegree, pitch * kDegree}));
    EXPECT_NEAR(wrapped_angle(found.yaw() - yaw * kDegree), 0.0, 2.0 * kDegree) << yaw << ", " << pitch;
    EXPECT_NEAR(found.pitch(), pitch * kDegree, 0.1 * kDegree) << yaw << ", " << pitch;
  }
}

TEST(CameraMount, SmallAnglesAndPathsThatSayNothingAreLeftAlone) {
  EXPECT_EQ(CameraMount::of_path(circle({1.0 * kDegree, 1.0 * kDegree})).rotation(),
            Eigen::Matrix3d::Identity());
  EXPECT_EQ(CameraMount::of_path({}).rotation(), Eigen::Matrix3d::Identity());
  EXPECT_EQ(CameraMount::of_path(Trajectory(5)).rotation(), Eigen::Matrix3d::Identity());
}

TEST(CameraMount, TheRobotsWayIsThatOfAnyCameraOnIt) {
  const CameraMount mount(-60.0 * kDegree, 10.0 * kDegree);
  const Trajectory seen = circle(mount);
  const SE3 robot = mount.to_robot(seen.front().T_wc.inverse() * seen.back().T_wc);
  const PlanePose plane = plane_pose(robot);
  const double angle = 0.03 * 199;
  EXPECT_NEAR(plane.x, 5.0 * std::sin(angle), 1e-9);
  EXPECT_NEAR(plane.y, 5.0 * (1.0 - std::cos(angle)), 1e-9);
}

}  // namespace
}  // namespace penumbra::slam::brain
