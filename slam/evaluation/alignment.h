// The similarity (or rigid motion) that lays one trajectory best over another.
//
// Given positions x_i of the estimate and y_i of the reference, find scale c, rotation R, translation t that
// minimise  1/n sum || y_i - (c R x_i + t) ||^2:
//
//   Sigma = 1/n sum (y_i - mean_y)(x_i - mean_x)^T = U D V^T                     (SVD)
//   R = U S V^T,  S = diag(1, 1, det(U) det(V))
//   c = trace(D S) / (1/n sum || x_i - mean_x ||^2)      (1 for a rigid alignment)
//   t = mean_y - c R mean_x
//
// Source: S. Umeyama, Least-Squares Estimation of Transformation Parameters Between Two Point Patterns,
// IEEE PAMI 13(4), 1991, equations 34..43.
//
// Degenerate input: where Sigma has rank 1 (both paths straight lines) the turn about the line is free, and
// where it has rank 0 (a single pose, a path that does not move) every turn is; the smallest turn is taken,
// which minimises the same sum. Such a result is marked is_unique = false. A path that does not move keeps c
// = 1.
#pragma once

#include <string_view>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

enum class Alignment { none, se3, sim3 };
// "none", "se3" or "sim3"; throws UsageError for another name.
Alignment parse_alignment(std::string_view name);
const char* to_string(Alignment alignment);

struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // metres
  bool is_unique = true;                                  // false: degenerate input, see above

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return scale * (rotation * point) + translation;
  }
};

// From the estimate's world to the reference's; the identity for Alignment::none. The trajectories are paired
// index by index; throws InputError where they are empty or differ in length.
Similarity find_alignment(const Trajectory& reference, const Trajectory& estimate, Alignment alignment);

// The trajectory with every position moved by `alignment` and every orientation turned by its rotation.
Trajectory transformed(const Trajectory& trajectory, const Similarity& alignment);

// Throws InputError unless both hold the same number of poses, at least `minimum`.
void require_paired(const Trajectory& reference, const Trajectory& estimate, int minimum);

}  // namespace penumbra::slam
