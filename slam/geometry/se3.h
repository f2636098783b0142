// Rigid motions of space, SE(3): x_a = R x_b + t, written T_ab.
//
//   exp:  xi = (rho, phi) in R^6  ->  R = exp([phi]x),  t = V(phi) rho          rho in metres, phi in radians
//   log:  the inverse, with |phi| <= pi
//   [phi]x is the skew matrix of phi;  V(phi) = I + (1 - cos a)/a^2 [phi]x + (a - sin a)/a^3 [phi]x^2,
//   a = |phi|
//
// Perturbations are on the left throughout Penumbra: T <- exp(xi) T.
// Source: Barfoot, State Estimation for Robotics (2017), section 7.1; Eade, Lie Groups for 2D and 3D
// Transformations.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace penumbra::slam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// [v]x, the matrix with [v]x w = v x w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

// Rotation vector (axis times angle in radians) to rotation matrix and back; so3_log returns |phi| <= pi.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

// Rz(yaw) Ry(pitch) Rx(roll), as inertial sensors give rotations; radians.
Eigen::Matrix3d so3_from_roll_pitch_yaw(double roll, double pitch, double yaw);

struct SE3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // metres

  static SE3 exp(const Vector6d& xi);
  Vector6d log() const;

  SE3 inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  SE3 operator*(const SE3& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }

  // Angle of the rotation in radians, 0..pi.
  double angle() const { return so3_log(rotation).norm(); }
  // A proper rotation replaces `rotation`, which rounding has made e short of one; it is the nearest up to
  // terms of e^2. Call after long chains of products.
  void normalize();
  bool is_finite() const { return rotation.allFinite() && translation.allFinite(); }
};

// The inverse, its rotation a proper one however long the chain of products was that T came from.
SE3 proper_inverse(SE3 T);

// Where a camera is: C with T_cw C = 0, in the world.
inline Eigen::Vector3d camera_centre(const SE3& T_cw) { return T_cw.inverse().translation; }

// Ad(T), which carries a small motion through T:  T exp(xi) T^-1 = exp(Ad(T) xi);  [ R  [t]x R ; 0  R ].
Matrix6d adjoint(const SE3& T);

// J^-1 of the left Jacobian of SE(3) at xi:  log(exp(x) exp(xi)) = xi + J^-1(xi) x + O(|x|^2). The right one
// is J_r^-1(xi) = J^-1(-xi). Barfoot (2017), equations 7.86 and 7.95.
Matrix6d left_jacobian_inverse(const Vector6d& xi);

}  // namespace penumbra::slam
