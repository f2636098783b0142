// Bundle adjustment: camera poses and points together, from many pixel measurements.
//
//   minimise over T_i, X_j    sum over observations  rho( |pi(T_i X_j) - z_ij|^2 / sigma_ij^2 )
//
// Levenberg-Marquardt. With the unknowns ordered poses first, points second, the normal equations are
//
//   [ U    W ] [ dx ]     [ g_x ]          U: 6x6 blocks on the diagonal, one per free pose
//   [ W^T  V ] [ dX ] = - [ g_X ]          V: 3x3 blocks on the diagonal, one per point
//
// and since V is block diagonal the points can be eliminated (Schur complement):
//
//   (U - W V^-1 W^T) dx = -g_x + W V^-1 g_X,        dX = -V^-1 (g_X + W^T dx)
//
// Damping: the diagonals of U and V are multiplied by 1 + lambda. Perturbation T <- exp(dx) T on the left.
//
// The disparity offset d0 of the stereo camera may be one more unknown: it borders the equations of the poses
// with a column s and a number c, which lose what the points explain just as U does. With one factorisation,
//
//   S = U - W V^-1 W^T,   S x = right,   S y = s,      dd0 = (r - s^T x) / (c - s^T y),   dx = x - y dd0
//
// A prior keeps d0 by 0 where the measurements say nothing about it.
//
// Several threads share the points of a large problem, in kBundleParts parts whose sums are added in a fixed
// order: the result is the same for any number of threads, to the last bit.
// Cost of an iteration: O(observations * observations per point) for the elimination, O((6 poses)^3) to
// solve, or much less where poses share points with few others (reduced_camera_system.h). Source: Triggs et
// al., Bundle Adjustment - A Modern Synthesis (2000), section 6; Lourakis, Argyros, SBA (2009).
#pragma once

#include <atomic>
#include <vector>

#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

inline constexpr int kBundleParts = 4;
// Observations from which on threads are worth their start: a few milliseconds an iteration.
inline constexpr std::size_t kBundleWorthThreads = 20000;

struct BundleObservation {
  int pose = 0, point = 0;  // indices
  PixelMeasurement measurement;
  bool active = true;  // others are left out
};

struct BundleProblem {
  StereoCamera camera;
  std::vector<SE3> poses;        // T_cw
  std::vector<char> pose_fixed;  // per pose
  std::vector<Eigen::Vector3d> points;
  std::vector<BundleObservation> observations;  // ordered by point
  // Pixels, deviation of the camera's disparity offset from 0 before anything is measured; 0: not adjusted.
  double disparity_offset_sigma = 0.0;
};

struct BundleSettings {
  int iterations = 10;  // at most
  int threads = 1;
  bool robust = true;  // Huber kernel with the chi-square gate as its bound
  double initial_lambda = 1e-5;
  double converged = 1e-4;                  // relative decrease of the cost that ends the iterations
  const std::atomic<bool>* stop = nullptr;  // set by somebody else: no further iteration begins
};

struct BundleSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;
};

// One solution of the damped normal equations.
struct BundleStep {
  std::vector<Vector6d> poses;  // zero for fixed ones
  std::vector<Eigen::Vector3d> points;
  double disparity_offset = 0.0;
};

// Improves problem.poses, problem.points and, where it is adjusted, the camera's disparity offset; the cost
// never rises. Points that no active observation sees
// stay.
BundleSummary solve_bundle(BundleProblem& problem, const BundleSettings& settings);

// The first step that solve_bundle would try with damping `lambda`.
BundleStep bundle_step(const BundleProblem& problem, bool robust, double lambda);

}  // namespace penumbra::slam
