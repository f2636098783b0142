#include "slam/backend/bundle_adjustment.h"

namespace penumbra::slam {

namespace {

// The unknowns, their trial values and the equations, as levenberg_marquardt.h wants them.
class Bundle {
 public:
  Bundle(BundleProblem& problem, const BundleSettings& settings)
      : problem_(problem), equations_(problem, settings.robust, settings.threads) {}

  double cost() { return equations_.cost(problem_.camera, problem_.poses, problem_.points); }
  void linearize() { equations_.linearize(); }
  bool solve(double lambda) { return equations_.solve(lambda, step_); }
  double trial_cost() {
    poses_ = problem_.poses;
    points_ = problem_.points;
    camera_ = problem_.camera;
    camera_.disparity_offset += step_.disparity_offset;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (problem_.pose_fixed[i]) continue;
      poses_[i] = SE3::exp(step_.poses[i]) * poses_[i];
      poses_[i].normalize();
    }
    for (std::size_t j = 0; j < points_.size(); ++j) points_[j] += step_.points[j];
    return equations_.cost(camera_, poses_, points_);
  }
  void accept() {
    problem_.camera = camera_;
    problem_.poses.swap(poses_);
    problem_.points.swap(points_);
  }

 private:
  BundleProblem& problem_;
  BundleEquations equations_;
  BundleStep step_;
  StereoCamera camera_;
  std::vector<SE3> poses_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace

LeastSquaresSummary solve_bundle(BundleProblem& problem, const BundleSettings& settings) {
  Bundle bundle(problem, settings);
  return levenberg_marquardt(bundle, {.iterations = settings.iterations,
                                      .initial_lambda = settings.initial_lambda,
                                      .smallest_lambda = 1e-10,
                                      .converged = settings.converged,
                                      .stop = settings.stop});
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
