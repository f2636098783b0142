// How the camera is turned on the robot.
//
//   v_robot = M v_camera,     T_robot = M T_camera M^-1       for motions T
//
// The robot's axes are x to its right, y down, z where it drives; those of a camera that looks ahead, level,
// are the same, M = I. Where the camera stands on the robot does not matter here: the place that is followed
// is the camera's own.
#pragma once

#include "slam/geometry/trajectory.h"

namespace penumbra::slam::brain {

class CameraMount {
 public:
  CameraMount() = default;
  // Radians by which the camera looks to the left of where the robot drives, and down.
  CameraMount(double yaw, double pitch);
  // What a path of the camera says: the mean turn of a robot on the ground is about its vertical, the mean
  // step leads ahead. I where a turn of less than 3 degrees would come of it, which slopes make as well.
  static CameraMount of_path(const Trajectory& T_wc);

  SE3 to_robot(const SE3& camera_motion) const { return conjugate(rotation_, camera_motion); }
  SE3 to_camera(const SE3& robot_motion) const { return conjugate(rotation_.transpose(), robot_motion); }

  double yaw() const { return std::atan2(-rotation_(0, 2), rotation_(2, 2)); }
  double pitch() const { return std::atan2(rotation_(1, 2), std::hypot(rotation_(0, 2), rotation_(2, 2))); }
  const Eigen::Matrix3d& rotation() const { return rotation_; }

 private:
  static SE3 conjugate(const Eigen::Matrix3d& M, const SE3& T) {
    return {M * T.rotation * M.transpose(), M * T.translation};
  }
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();  // M
};

}  // namespace penumbra::slam::brain
