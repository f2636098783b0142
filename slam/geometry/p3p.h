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

#include "nn/base/short_list.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

// `points`: in the world; `rays`: unit vectors in the camera's frame. Returns up to four poses T_cw; none for
// points on one line or rays that coincide.
ShortList<SE3, 4> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                            const std::array<Eigen::Vector3d, 3>& rays);

// Real roots of c[0] + c[1] x + ... + c[4] x^4, polished by Newton's method; leading zeros are allowed.
ShortList<double, 4> real_roots(const std::array<double, 5>& coefficients);

}  // namespace penumbra::slam
