#include "slam/backend/bundle_adjustment.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

constexpr double kMaxLambda = 1e8;

}  // namespace

BundleSummary solve_bundle(BundleProblem& problem, const BundleSettings& settings) {
  BundleEquations equations(problem, settings.robust, settings.threads);
  BundleSummary summary;
  summary.initial_cost = summary.final_cost = equations.cost(problem.camera, problem.poses, problem.points);
  double lambda = settings.initial_lambda;
  BundleStep step;
  bool linearized = false;
  while (summary.iterations < settings.iterations && lambda < kMaxLambda) {
    if (settings.stop != nullptr && settings.stop->load(std::memory_order_relaxed)) break;
    ++summary.iterations;
    if (!linearized) equations.linearize();
    linearized = true;
    if (!equations.solve(lambda, step)) {
      lambda *= 100.0;
      continue;
    }
    std::vector<SE3> poses = problem.poses;
    std::vector<Eigen::Vector3d> points = problem.points;
    StereoCamera camera = problem.camera;
    camera.disparity_offset += step.disparity_offset;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (problem.pose_fixed[i]) continue;
      poses[i] = SE3::exp(step.poses[i]) * poses[i];
      poses[i].normalize();
    }
    for (std::size_t j = 0; j < points.size(); ++j) points[j] += step.points[j];
    const double cost = equations.cost(camera, poses, points);
    if (!(cost <= summary.final_cost)) {
      lambda *= 10.0;
      continue;
    }
    const bool converged = summary.final_cost - cost <= settings.converged * summary.final_cost;
    problem.camera = camera;
    problem.poses.swap(poses);
    problem.points.swap(points);
    summary.final_cost = cost;
    lambda = std::max(lambda * 0.1, 1e-10);
    linearized = false;
    if (converged) break;
  }
  return summary;
}

bool within_gate(const BundleProblem& problem, const BundleObservation& o) {
  const Eigen::Vector3d p =
      problem.poses[static_cast<std::size_t>(o.pose)] * problem.points[static_cast<std::size_t>(o.point)];
  return within_gate(problem.camera, p, o.measurement);
}

BundleStep bundle_step(const BundleProblem& problem, bool robust, double lambda) {
  BundleEquations equations(problem, robust, 1);
  equations.linearize();
  BundleStep step;
  if (!equations.solve(lambda, step)) return {};
  return step;
}

}  // namespace penumbra::slam
