#include "slam/dynamics/dual_constraint.h"

#include <Eigen/LU>
#include <cmath>

#include "slam/dynamics/object_motion.h"
#include "slam/geometry/chi_square.h"
#include "slam/geometry/reprojection.h"
#include "slam/geometry/triangulation.h"

namespace penumbra::slam {

DualConstraint::DualConstraint(const StereoCamera& camera, const SE3& T_c_k,
                               const DualConstraintSettings& settings)
    : camera_(camera), T_c_k_(T_c_k), settings_(settings), F_(fundamental_matrix(camera, SE3{}, T_c_k)) {}

std::optional<PointDifference> DualConstraint::compare(const MeasuredPoint& before,
                                                       const MeasuredPoint& now) const {
  const Eigen::Vector3d p = T_c_k_ * camera_.back_project(before.pixel.x(), before.pixel.y(), before.depth);
  if (!(p.z() > 0.0)) return std::nullopt;

  // Of the point in C, as K measured it, and the pose between the two.
  const auto measured = [&](const MeasuredPoint& point) {
    return position_covariance(camera_, point.pixel, point.depth, settings_.pixel_sigma * point.scale,
                               settings_.disparity_sigma * point.scale);
  };
  const Eigen::Matrix3d covariance =
      T_c_k_.rotation * measured(before) * T_c_k_.rotation.transpose() +
      settings_.pose_sigma * settings_.pose_sigma * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 2, 3> J =
      projection_jacobian(camera_, p, /*stereo=*/false).topRows<2>();  // of the pixel
  const double now_sigma = settings_.pixel_sigma * now.scale;
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
    difference.depth_score = dz * dz / (covariance(2, 2) + measured(now)(2, 2));
  }
  return difference;
}

bool DualConstraint::moves(const PointDifference& d) const {
  const double dz = d.depth.value_or(0.0);
  if (settings_.mode == StaticPointMode::paper) {
    if (d.line > settings_.line_pixels) return true;
    return d.shift > settings_.shift_pixels || dz > settings_.depth_metres || d.shift + dz > settings_.score;
  }
  return d.line_score > kPlainChiSquare1 || d.shift_score > kPlainChiSquare2 ||
         d.depth_score > kPlainChiSquare1 || d.shift_score + d.depth_score > kChiSquare3;
}

}  // namespace penumbra::slam
