// Whether a point stood still between two views whose relative pose is known: the dual static-point
// constraint.
//
// A point S is seen at S1 in a view K, with a depth; it should be seen at S2 = (u2, v2), at depth z1, in the
// view C, and is matched at S2' with measured depth z2. With F the fundamental matrix of the two poses:
//
//   l2 = F x1 = (A, B, C),   D = |A u2' + B v2' + C| / sqrt(A^2 + B^2)                                (13-14)
//   Delta_d = |S2 - S2'|,    Delta_z = |z1 - z2|
//   T = lambda D + mu (Delta_d + Delta_z)                                                             (15)
//
// Mode `paper`: D > tau_D: it moves (lambda = 1, mu = 0). Else (lambda = 0, mu = 1) it moves where Delta_d >
// tau_d or Delta_z > tau_z or, where both are just below, T > tau_T. The sum adds pixels to metres, as the
// paper has it. The line alone cannot tell what moves along it, towards the camera above all: the depth does.
//
// Mode `adaptive`: the same three figures, each in units of its own uncertainty,
//
//   D^2 / var(D) > q1,   dS^T cov(dS)^-1 dS > q2,   Delta_z^2 / var(Delta_z) > q1,
//   or the sum of the last two > q3
//
// with q_k the 99 % quantiles of chi-square (q3: 95 %), and covariances of the pixels by pyramid level and of
// depths as they are measured (1/z has an even error, so sigma_z ~ z^2), propagated from K to C, plus what
// the pose between the two may be wrong by. A point that is near or coarse may move more before it counts.
//
// Where the camera has not moved the line is undefined and D is 0. Points without depth in C have no Delta_z.
// Cost: 0.2 us a point. Source: see slam/dynamics/rgbd/foreground_depths.h.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

enum class StaticPointMode { off, paper, adaptive };

struct DualConstraintSettings {
  StaticPointMode mode = StaticPointMode::off;
  // Of `paper`; it gives no values.
  double line_pixels = 1.5;    // tau_D
  double shift_pixels = 3.0;   // tau_d
  double depth_metres = 0.15;  // tau_z
  double score = 3.1;          // tau_T
  // Of `adaptive`: deviations at level 0.
  double pixel_sigma = 0.5;      // pixels
  double disparity_sigma = 0.1;  // pixels, of depth
  double pose_sigma = 0.002;     // metres, of the pose between the views
};

// A point as one view has measured it.
struct MeasuredPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth = 0.0;  // metres; not above 0: unknown
  double scale = 1.0;  // of its pyramid level
};

// How a point's match differs from where the point would be if it stood still.
struct PointDifference {
  double line = 0.0;            // D, pixels
  double shift = 0.0;           // Delta_d, pixels
  std::optional<double> depth;  // Delta_z, metres
  // Squares of the same in units of their uncertainties.
  double line_score = 0.0, shift_score = 0.0, depth_score = 0.0;
};

class DualConstraint {
 public:
  // `T_c_k`: from K's camera to C's.
  DualConstraint(const StereoCamera& camera, const SE3& T_c_k, const DualConstraintSettings& settings);

  // `before` in K, with depth; `now` in C. Nothing where the point would be behind C's camera.
  std::optional<PointDifference> compare(const MeasuredPoint& before, const MeasuredPoint& now) const;
  bool moves(const PointDifference& difference) const;

 private:
  const StereoCamera camera_;
  const SE3 T_c_k_;
  const DualConstraintSettings settings_;
  Eigen::Matrix3d F_;
};

}  // namespace penumbra::slam
