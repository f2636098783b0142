#include "slam/dynamics/object_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/quantile.h"
#include "slam/geometry/chi_square.h"

namespace penumbra::slam {

namespace {

constexpr int kRounds = 6, kRobustRounds = 4;  // in the last ones foreign points have no say at all

// The median of every component: a start that half of the points cannot spoil.
Eigen::Vector3d median_velocity(std::span<const PointDisplacement> points) {
  Eigen::Vector3d median;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < points.size(); ++k) values[k] = points[k].metres[axis] / points[k].seconds;
    median[axis] = quantile_of(values, 0.5);
  }
  return median;
}

double log_normal_at_zero_mean(const Eigen::Vector3d& v, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  const Eigen::Vector3d whitened = llt.matrixL().solve(v);
  return -0.5 * whitened.squaredNorm() - llt.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

Eigen::Matrix3d position_covariance(const StereoCamera& camera, const Eigen::Vector2d& pixel, double depth,
                                    double pixel_sigma, double disparity_sigma) {
  const double disparity = camera.fx * camera.baseline / depth;
  Eigen::Matrix3d J;
  J << depth / camera.fx, 0.0, -(pixel.x() - camera.cx) / camera.fx * depth / disparity,  //
      0.0, depth / camera.fy, -(pixel.y() - camera.cy) / camera.fy * depth / disparity,   //
      0.0, 0.0, -depth / disparity;
  const double p = pixel_sigma, d = disparity_sigma;
  return J * Eigen::Vector3d(p * p, p * p, d * d).asDiagonal() * J.transpose();
}

Eigen::Matrix3d stereo_covariance(const StereoCamera& camera, const FeatureView& features, int feature,
                                  double scale, const ObjectMotionSettings& settings) {
  const FeaturePixel k = features.pixel(feature);
  return position_covariance(camera, {k.u, k.v}, features.depth(feature), settings.pixel_sigma * scale,
                             settings.disparity_sigma * scale);
}

std::optional<ObjectVelocity> estimate_velocity(std::span<const PointDisplacement> points,
                                                const ObjectMotionSettings& settings) {
  if (static_cast<int>(points.size()) < std::max(1, settings.fewest_points)) return std::nullopt;
  ObjectVelocity found;
  found.metres_per_second = median_velocity(points);
  double longest = 0.0;
  Eigen::Matrix3d information;
  for (int round = 0; round < kRounds; ++round) {
    information.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    found.inliers = 0;
    for (const PointDisplacement& point : points) {
      const Eigen::Matrix3d weight = point.covariance.inverse();
      const Eigen::Vector3d e = point.metres - found.metres_per_second * point.seconds;
      const double squared = e.dot(weight * e);
      const double outside = round < kRobustRounds ? std::sqrt(kChiSquare3 / squared) : 0.0;
      const double huber = squared <= kChiSquare3 ? 1.0 : outside;
      information += huber * point.seconds * point.seconds * weight;
      right += huber * point.seconds * (weight * point.metres);
      found.inliers += squared <= kChiSquare3;
      longest = std::max(longest, std::abs(point.seconds));
    }
    found.metres_per_second = information.ldlt().solve(right);
  }
  if (found.inliers < settings.fewest_points || 2 * found.inliers < static_cast<int>(points.size()) ||
      !found.metres_per_second.allFinite()) {
    return std::nullopt;
  }
  const double camera = settings.camera_sigma / longest;
  found.covariance = information.inverse() + camera * camera * Eigen::Matrix3d::Identity();
  return found;
}

double moving_evidence(const ObjectVelocity& velocity, const ObjectMotionSettings& settings) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const double still = settings.still_sigma, moving = settings.moving_sigma;
  return log_normal_at_zero_mean(velocity.metres_per_second, velocity.covariance + moving * moving * one) -
         log_normal_at_zero_mean(velocity.metres_per_second, velocity.covariance + still * still * one);
}

}  // namespace penumbra::slam
