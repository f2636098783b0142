// Whether an object moves by itself, from what its points did while the camera's own motion is taken out.
//
//   D_k = X_k(t) - X_k(t_k)            stereo positions of point k now and when it was first seen, metres
//   S_k = cov X_k(t) + cov X_k(t_k),   cov X = J diag(s^2, s^2, s_d^2) J^T,   J = d(X, Y, Z) / d(u, v, d)
//   v   = argmin sum rho( (D_k - v dt_k)^T S_k^-1 (D_k - v dt_k) )            Huber, reweighted least
//                                                            squares; the last rounds take inliers only
//   P   = (sum w dt_k^2 S_k^-1)^-1 + (c / dt)^2 I            c: what the camera's own pose may be wrong by
//
// The evidence compares two models of the velocity, one that stands up to a slack of s_still and one that may
// move with any velocity a road knows, s_moving:
//
//   log p(v | moving) - log p(v | still) = log N(v; 0, P + s_moving^2 I) - log N(v; 0, P + s_still^2 I)
//
// It is positive only where v stands out of its own uncertainty: few or far points say little, which is what
// they know. Cost: O(points), some microseconds. Source: the stereo scene flow residual of Alcantarilla et
// al., On Combining Visual SLAM and Dense Scene Flow (ICRA 2012), as a Bayes factor.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

struct ObjectMotionSettings {
  double pixel_sigma = 0.7, disparity_sigma = 0.5;  // pixels, at level 0
  double camera_sigma = 0.03;                       // c, metres
  double still_sigma = 0.15;                        // s_still, metres a second
  double moving_sigma = 5.0;                        // s_moving
  int fewest_points = 4;                            // that must agree with v
};

// Displacement of one point over `seconds` (may be negative) with its covariance.
struct PointDisplacement {
  Eigen::Vector3d metres = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double seconds = 0.0;
};

struct ObjectVelocity {
  Eigen::Vector3d metres_per_second = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // P
  int inliers = 0;
};

// Covariance of the position, metres^2, of what is seen at `pixel`, `depth` metres away, in the camera's
// frame; deviations in pixels.
Eigen::Matrix3d position_covariance(const StereoCamera& camera, const Eigen::Vector2d& pixel, double depth,
                                    double pixel_sigma, double disparity_sigma);

// Covariance of a feature's stereo position in the camera's frame, metres^2; the feature has stereo depth.
Eigen::Matrix3d stereo_covariance(const StereoCamera& camera, const FeatureView& features, int feature,
                                  double scale, const ObjectMotionSettings& settings);

// Nothing where fewer than `fewest_points`, or less than half of the points, agree.
std::optional<ObjectVelocity> estimate_velocity(std::span<const PointDisplacement> points,
                                                const ObjectMotionSettings& settings);

// log p(v | moving) - log p(v | still).
double moving_evidence(const ObjectVelocity& velocity, const ObjectMotionSettings& settings);

}  // namespace penumbra::slam
