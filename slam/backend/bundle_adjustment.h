// Bundle adjustment: camera poses and points together, from many pixel measurements.
//
//   minimise over T_i, X_j    sum over observations  rho( |pi(T_i X_j) - z_ij|^2 / sigma_ij^2 )
//
// Levenberg-Marquardt (levenberg_marquardt.h) on the equations of bundle_equations.h. The stereo camera's
// disparity offset is adjusted, too, where the problem says so; its prior is then part of the cost.
#pragma once

#include <atomic>

#include "slam/backend/bundle_equations.h"
#include "slam/geometry/levenberg_marquardt.h"

namespace penumbra::slam {

struct BundleSettings {
  int iterations = 10;  // at most
  int threads = 1;
  bool robust = true;  // Huber kernel with the chi-square gate as its bound
  double initial_lambda = 1e-5;
  double converged = 1e-4;                  // relative decrease of the cost that ends the iterations
  const std::atomic<bool>* stop = nullptr;  // set by somebody else: no further iteration begins
};

// Improves problem.poses, problem.points and, where it is adjusted, the camera's disparity offset; the cost
// never rises. Points that no active observation sees stay.
LeastSquaresSummary solve_bundle(BundleProblem& problem, const BundleSettings& settings);

// Whether the observation is within its chi-square gate, its point before the camera.
bool within_gate(const BundleProblem& problem, const BundleObservation& o);

// The first step that solve_bundle would try with damping `lambda`.
BundleStep bundle_step(const BundleProblem& problem, bool robust, double lambda);

}  // namespace penumbra::slam
