#include "slam/brain/motion/camera_mount.h"

#include <Eigen/Geometry>

namespace penumbra::slam::brain {

CameraMount::CameraMount(double yaw, double pitch)
    : rotation_((Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitX()))
                    .toRotationMatrix()) {}

CameraMount CameraMount::of_path(const Trajectory& T_wc) {
  Eigen::Vector3d turns = Eigen::Vector3d::Zero(), way = turns;
  double turned = 0.0, length = 0.0;
  for (std::size_t i = 1; i < T_wc.size(); ++i) {
    const SE3 step = T_wc[i - 1].T_wc.inverse() * T_wc[i].T_wc;
    const Eigen::Vector3d turn = so3_log(step.rotation);
    turns += turn.y() >= 0.0 ? turn : -turn;  // to the right: about y, which points down
    turned += turn.norm();
    way += step.translation;
    length += step.translation.norm();
  }
  // Of a path that hardly turns the vertical is the camera's, and so is the way of one that hardly leads on.
  constexpr double kLeastTurn = 0.5, kLeastShare = 0.5;
  const bool turns_say = turned > kLeastTurn && turns.norm() > kLeastShare * turned;
  const Eigen::Vector3d down = turns_say ? turns.normalized() : Eigen::Vector3d::UnitY();
  const bool leads_on = way.norm() > kLeastShare * length && length > 0.0;
  Eigen::Vector3d ahead = leads_on ? way : Eigen::Vector3d::UnitZ();
  ahead -= ahead.dot(down) * down;
  if (ahead.norm() < 1e-3) return {};
  ahead.normalize();
  CameraMount mount;
  mount.rotation_.row(0) = down.cross(ahead).transpose();
  mount.rotation_.row(1) = down.transpose();
  mount.rotation_.row(2) = ahead.transpose();
  constexpr double kLeastAngle = 0.0524;  // 3 degrees
  return so3_log(mount.rotation_).norm() < kLeastAngle ? CameraMount() : mount;
}

}  // namespace penumbra::slam::brain
