// Pose graph: camera poses that best agree with measured motions between pairs of them.
//
//   minimise over T_i    sum over edges (i, j)   e^T Omega e,     e = log( T_i T_j^-1 Z^-1 )
//
// T_i is T_cw of pose i, Z the measured motion T_ij (pose j's frame to pose i's), Omega the inverse
// covariance of the measurement. e is in (metres, radians) and zero where poses and measurement agree. With
// the perturbations T <- exp(x) T,
//
//   de/dx_i = J^-1(e),       de/dx_j = -J^-1(-e) Ad(Z)
//
// where J is SE(3)'s left Jacobian. Levenberg-Marquardt; the normal equations have a 6 x 6 block for every
// pose and every edge and are solved by a sparse factor of such blocks (block_cholesky.h). Source: Grisetti,
// Kuemmerle, Stachniss, Burgard, A Tutorial on Graph-Based SLAM (2010); Barfoot, State Estimation for
// Robotics (2017), section 9.2.
#pragma once

#include <vector>

#include "slam/geometry/levenberg_marquardt.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct PoseGraphEdge {
  int i = 0, j = 0;                             // indices of poses, different
  SE3 T_ij;                                     // measured
  Matrix6d information = Matrix6d::Identity();  // Omega: 1/m^2, 1/rad^2; symmetric, positive definite
};

struct PoseGraph {
  std::vector<SE3> poses;   // T_cw
  std::vector<char> fixed;  // per pose; every connected part needs one
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphSettings {
  int iterations = 20;  // at most
  double initial_lambda = 1e-8;
  double converged = 1e-6;  // relative decrease of the cost that ends the iterations
};

// e and its derivatives for one edge.
struct PoseGraphResidual {
  Vector6d e;
  Matrix6d J_i, J_j;
};
PoseGraphResidual pose_graph_residual(const SE3& T_i, const SE3& T_j, const SE3& T_ij);

// Improves graph.poses; the cost never rises. Poses without an edge stay. Throws UsageError for an edge
// whose ends are equal or out of range.
LeastSquaresSummary solve_pose_graph(PoseGraph& graph, const PoseGraphSettings& settings = {});

}  // namespace penumbra::slam
