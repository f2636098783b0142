#include "slam/geometry/se3.h"

#include <cmath>

namespace penumbra::slam {

namespace {

// Below this angle (radians) the series replace the closed forms, whose differences cancel.
constexpr double kSmallAngle = 1e-5;

// V(phi): integrates the rotation along the translation.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d K = skew(phi);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * K + K * K / 6.0;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / a2 * K +
         (angle - std::sin(angle)) / (a2 * angle) * K * K;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d K = skew(phi);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + K + 0.5 * K * K;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * K +
         (1.0 - std::cos(angle)) / (angle * angle) * K * K;
}

Eigen::Matrix3d so3_from_roll_pitch_yaw(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  // Through the quaternion: well conditioned at every angle, unlike acos((trace - 1) / 2).
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const double sine = q.vec().norm();  // sin(angle / 2)
  if (sine < 1e-12) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

SE3 SE3::exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return {so3_exp(phi), left_jacobian(phi) * xi.head<3>()};
}

Vector6d SE3::log() const {
  Vector6d xi;
  const Eigen::Vector3d phi = so3_log(rotation);
  xi << left_jacobian(phi).partialPivLu().solve(translation), phi;
  return xi;
}

Matrix6d adjoint(const SE3& T) {
  Matrix6d Ad = Matrix6d::Zero();
  Ad.topLeftCorner<3, 3>() = Ad.bottomRightCorner<3, 3>() = T.rotation;
  Ad.topRightCorner<3, 3>() = skew(T.translation) * T.rotation;
  return Ad;
}

Matrix6d left_jacobian_inverse(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  const Eigen::Matrix3d P = skew(phi), R = skew(xi.head<3>());
  const double a = phi.norm(), a2 = a * a;
  // Q of Barfoot (7.86) with rho -> R, phi -> P; the coefficients by their series near zero.
  double c1 = 1.0 / 6.0 - a2 / 120.0, c2 = 1.0 / 24.0 - a2 / 720.0, c3 = 1.0 / 120.0 - a2 / 2520.0;
  if (a > 0.05) {
    const double sine = std::sin(a), cosine = std::cos(a), a3 = a2 * a;
    c1 = (a - sine) / a3;
    c2 = (a2 + 2.0 * cosine - 2.0) / (2.0 * a2 * a2);
    c3 = (2.0 * a - 3.0 * sine + a * cosine) / (2.0 * a2 * a3);
  }
  const Eigen::Matrix3d PR = P * R, RP = R * P, PRP = P * RP;
  const Eigen::Matrix3d Q =
      0.5 * R + c1 * (PR + RP + PRP) + c2 * (P * PR + RP * P - 3.0 * PRP) + c3 * (PRP * P + P * PRP);
  const Eigen::Matrix3d J_inverse = left_jacobian(phi).inverse();
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = result.bottomRightCorner<3, 3>() = J_inverse;
  result.topRightCorner<3, 3>() = -J_inverse * Q * J_inverse;
  return result;
}

void SE3::normalize() { rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix(); }

SE3 proper_inverse(SE3 T) {
  T.normalize();
  return T.inverse();
}

}  // namespace penumbra::slam
