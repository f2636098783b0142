#include "slam/dynamics/dual_constraint.h"

#include <Eigen/LU>
#include <cmath>

#include "slam/geometry/chi_square.h"

namespace penumbra::slam {

namespace {

constexpr double kSurely1 = 6.635, kSurely2 = 9.210;  // 99 % quantiles of chi-square

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& t) {
  Eigen::Matrix3d m;
  m << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  return m;
}

// x2^T F x1 = 0 for the pixels of a point that stands still.
Eigen::Matrix3d fundamental_of(const StereoCamera& camera, const SE3& T) {
  Eigen::Matrix3d K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d inverse = K.inverse();
  return inverse.transpose() * cross_matrix(T.translation) * T.rotation * inverse;
}

}  // namespace

DualConstraint::DualConstraint(const StereoCamera& camera, const SE3& T_c_k,
                               const DualConstraintSettings& settings)
    : camera_(camera), T_c_k_(T_c_k), settings_(settings), F_(fundamental_of(camera, T_c_k)) {}

std::optional<PointDifference> DualConstraint::compare(const MeasuredPoint& before,
                                                       const MeasuredPoint& now) const {
  const double f = camera_.fx, sigma = settings_.pixel_sigma;
  // Deviation of a measured depth: disparity has an even error.
  const auto depth_variance = [&](double z, double scale) {
    const double s = z * z / (f * camera_.baseline) * settings_.disparity_sigma * scale;
    return s * s;
  };
  const Eigen::Vector3d point = camera_.back_project(before.pixel.x(), before.pixel.y(), before.depth);
  const Eigen::Vector3d p = T_c_k_ * point;
  if (!(p.z() > 0.0)) return std::nullopt;

  // Of the point in C: its ray's direction, its depth along it, and the pose.
  const double across = sigma * before.scale * before.depth / f;
  const Eigen::Vector3d along = point / point.z();
  Eigen::Matrix3d covariance = across * across * Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal().toDenseMatrix();
  covariance += depth_variance(before.depth, before.scale) * along * along.transpose();
  covariance = T_c_k_.rotation * covariance * T_c_k_.rotation.transpose();
  covariance += settings_.pose_sigma * settings_.pose_sigma * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 2, 3> J;                      // of the pixel
  J << f / p.z(), 0.0, -f * p.x() / (p.z() * p.z()),  //
      0.0, camera_.fy / p.z(), -camera_.fy * p.y() / (p.z() * p.z());
  const double now_sigma = sigma * now.scale;
  const Eigen::Matrix2d pixel_covariance =
      J * covariance * J.transpose() + now_sigma * now_sigma * Eigen::Matrix2d::Identity();

  PointDifference difference;
  const Eigen::Vector2d shift = now.pixel - camera_.project(p);
  difference.shift = shift.norm();
  difference.shift_score = shift.dot(pixel_covariance.inverse() * shift);
  const Eigen::Vector3d line = F_ * before.pixel.homogeneous();
  const double length = line.head<2>().norm();
  constexpr double kLeastBaseline = 1e-4;  // of the depth
  if (T_c_k_.translation.norm() > kLeastBaseline * before.depth && length > 0.0) {
    const Eigen::Vector2d normal = line.head<2>() / length;
    difference.line = std::abs(line.dot(now.pixel.homogeneous())) / length;
    difference.line_score = difference.line * difference.line / normal.dot(pixel_covariance * normal);
  }
  if (now.depth > 0.0) {
    const double dz = std::abs(p.z() - now.depth);
    difference.depth = dz;
    difference.depth_score = dz * dz / (covariance(2, 2) + depth_variance(now.depth, now.scale));
  }
  return difference;
}

bool DualConstraint::moves(const PointDifference& d) const {
  const double dz = d.depth.value_or(0.0);
  if (settings_.mode == StaticPointMode::paper) {
    if (d.line > settings_.line_pixels) return true;
    return d.shift > settings_.shift_pixels || dz > settings_.depth_metres || d.shift + dz > settings_.score;
  }
  return d.line_score > kSurely1 || d.shift_score > kSurely2 || d.depth_score > kSurely1 ||
         d.shift_score + d.depth_score > kChiSquare3;
}

}  // namespace penumbra::slam
