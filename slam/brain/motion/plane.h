// Motions of a robot on the ground: where it is and which way it looks.
//
//   a o b = ( p_a + R(theta_a) p_b,  theta_a + theta_b )        b is measured in a's frame
//
// The plane is that of the first camera's x and z axes: x points where the first camera looked, y to its
// left, theta turns from x to y (to the left) and lies in (-pi, pi]. Metres and radians.
#pragma once

#include <cmath>
#include <numbers>

#include "slam/geometry/se3.h"

namespace penumbra::slam::brain {

inline double wrapped_angle(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

struct PlanePose {
  double x = 0.0, y = 0.0, heading = 0.0;

  PlanePose operator*(const PlanePose& b) const {
    const double c = std::cos(heading), s = std::sin(heading);
    return {x + c * b.x - s * b.y, y + s * b.x + c * b.y, wrapped_angle(heading + b.heading)};
  }
  PlanePose inverse() const {
    const double c = std::cos(heading), s = std::sin(heading);
    return {-c * x - s * y, s * x - c * y, wrapped_angle(-heading)};
  }
  double distance() const { return std::hypot(x, y); }
  bool is_finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(heading); }
};

inline double distance_between(const PlanePose& a, const PlanePose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// T_wc of a camera that stands upright at the pose: y points down, z where it looks.
inline SE3 camera_pose(const PlanePose& pose) {
  SE3 T;
  T.rotation = Eigen::AngleAxisd(-pose.heading, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation = {-pose.y, 0.0, pose.x};
  return T;
}

// The part of a camera's pose, or of a motion between two cameras, that lies in the plane: the viewing axis
// tells the heading. A camera that looks straight up or down has heading 0.
inline PlanePose plane_pose(const SE3& T_wc) {
  const Eigen::Vector3d view = T_wc.rotation.col(2);
  return {T_wc.translation.z(), -T_wc.translation.x(), std::atan2(-view.x(), view.z())};
}

}  // namespace penumbra::slam::brain
