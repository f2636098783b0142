// Camera pose from three points: perspective-three-point.
//
// Unknown are the distances s1, s2, s3 of the points along their unit rays f1, f2, f3. With a = |P2 P3|,
// b = |P1 P3|, c = |P1 P2| and the cosines between the rays the law of cosines gives three equations; with
// s2 = u s1, s3 = v s1 they become a quartic in v. Each positive root gives the points in the camera's frame,
// and the rigid motion between two congruent triangles gives the pose.
//
// Source: Grunert (1841) in the form of Haralick et al., Review and Analysis of Solutions of the Three Point
// Perspective Pose Estimation Problem (IJCV 1994), section 3.1.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

// `points`: in the world; `rays`: unit vectors in the camera's frame. Returns up to four poses T_cw; none for
// points on one line or rays that coincide.
std::vector<SE3> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                           const std::array<Eigen::Vector3d, 3>& rays);

// Real roots of c[0] + c[1] x + ... + c[n] x^n, polished by Newton's method; leading zeros are allowed.
std::vector<double> real_roots(const std::vector<double>& coefficients);

}  // namespace penumbra::slam
