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

void SE3::normalize() { rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix(); }

}  // namespace penumbra::slam
