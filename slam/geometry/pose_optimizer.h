// The camera pose that best explains where known points are seen: robust Gauss-Newton with damping on SE(3).
//
//   minimise over T_cw   sum_i rho( |e_i|^2 / sigma_i^2 ),   e_i as in slam/geometry/reprojection.h
//   step:   (H + lambda diag H) xi = -g,   H = sum w J^T J / sigma^2,   g = sum w J^T e / sigma^2,
//           T <- exp(xi) T
//
// Three rounds: after each, pairs outside their chi-square gate (5.991 monocular, 7.815 stereo, times the
// variance of their level) are set aside, and may come back; the last round runs without the Huber kernel.
// About 0.5 ms for 1000 observations.
//
// Where few points are to be seen, what is expected of the motion may count as one more observation:
//   + |rho|^2 / sigma_t^2 + |phi|^2 / sigma_r^2,   (rho, phi) = log(T_cw T_expected^-1)
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), motion-only bundle adjustment.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/geometry/pnp_ransac.h"
#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

struct PoseEstimate {
  SE3 T_cw;
  std::vector<char> inlier;  // per observation
  int inliers = 0;
  // H of the last round, undamped: its inverse is the covariance of xi, for points that are known exactly.
  Matrix6d information = Matrix6d::Zero();
};

// What is known of the pose beforehand, with standard deviations in metres and radians.
struct PosePrior {
  SE3 T_cw;
  double metres = 0.0, radians = 0.0;
};

// Starts from `initial`. Observations that are not finite or behind the camera are outliers. Fewer than three
// usable observations, or a start that is not finite: `initial` comes back with no inliers.
PoseEstimate optimize_pose(const StereoCamera& camera, const SE3& initial,
                           std::span<const PoseObservation> observations,
                           const std::optional<PosePrior>& prior = std::nullopt);
// The same from what RANSAC has found: the first round leaves out what did not agree there. Where a third or
// more of the pairs are wrong, these would draw the pose away from all others.
PoseEstimate optimize_pose(const StereoCamera& camera, const PnpResult& initial,
                           std::span<const PoseObservation> observations);

}  // namespace penumbra::slam
