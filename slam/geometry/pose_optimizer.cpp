#include "slam/geometry/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <limits>

#include "slam/geometry/levenberg_marquardt.h"
#include "slam/geometry/pose_equations.h"

namespace penumbra::slam {

namespace {

constexpr int kPoseRounds = 3;
constexpr int kIterations = 8;       // at most, per round
constexpr double kConverged = 1e-5;  // relative decrease of the cost that ends a round
constexpr double kNearest = 0.05;    // metres in front of the camera
constexpr LeastSquaresSettings kDamping = {.iterations = kIterations,
                                           .initial_lambda = 1e-6,
                                           .smallest_lambda = 1e-9,
                                           .largest_lambda = 2e6,
                                           .raise = 100.0,
                                           .converged = kConverged};

struct NormalEquations {  // of H the lower triangle
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
};

class Problem {
 public:
  Problem(const StereoCamera& camera, std::span<const PoseObservation> observations,
          const std::optional<PosePrior>& prior)
      : camera_(camera), observations_(observations), prior_(prior), inlier_(observations.size(), 1) {
    usable_.reserve(observations.size());
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const PoseObservation& o = observations[i];
      usable_.push_back(o.point.allFinite() && o.measurement.pixel.allFinite());
      inlier_[i] = usable_.back();
    }
  }

  // Cost over the inliers, and their normal equations.
  NormalEquations evaluate(const SE3& T_cw, bool robust) const {
    NormalEquations n;
    if (prior_) add_prior(T_cw, n);
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (!inlier_[i]) continue;
      const PixelMeasurement& z = observations_[i].measurement;
      const Eigen::Vector3d p = T_cw * observations_[i].point;
      const double bound = robust ? z.gate() : std::numeric_limits<double>::infinity();
      if (p.z() < kNearest) {  // a constant cost, so that moving points behind the camera is no way out
        n.cost += 100.0 * z.gate();
        continue;
      }
      const Eigen::Vector3d e = reprojection_error(camera_, p, z);
      const Huber h = huber(e.squaredNorm() * z.inverse_variance, bound);
      n.cost += h.cost;
      const PoseEquations equations(projection_jacobian(camera_, p, z.stereo), p,
                                    h.weight * z.inverse_variance);
      equations.add_lower_hessian(n.H.data());
      equations.add_gradient(e, n.g.data());
    }
    return n;
  }

  // Sorts the observations into inliers and outliers at pose `T_cw`.
  int classify(const SE3& T_cw) {
    int count = 0;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      inlier_[i] = 0;
      if (!usable_[i]) continue;
      const PixelMeasurement& z = observations_[i].measurement;
      const Eigen::Vector3d p = T_cw * observations_[i].point;
      if (p.z() < kNearest) continue;
      inlier_[i] = within_gate(camera_, p, z);
      count += inlier_[i];
    }
    return count;
  }

  // Only these take part, until classify() is called.
  void begin_with(const std::vector<char>& inlier) {
    for (std::size_t i = 0; i < inlier_.size(); ++i) inlier_[i] = usable_[i] && inlier[i];
  }
  std::vector<char> inlier() const { return inlier_; }

 private:
  void add_prior(const SE3& T_cw, NormalEquations& n) const {
    const Vector6d e = (T_cw * prior_->T_cw.inverse()).log();
    Vector6d weight;
    weight.head<3>().setConstant(1.0 / (prior_->metres * prior_->metres));
    weight.tail<3>().setConstant(1.0 / (prior_->radians * prior_->radians));
    // The derivative of the logarithm is close to one for the small motions that a prior allows.
    n.cost += e.dot(weight.cwiseProduct(e));
    n.H.diagonal() += weight;
    n.g += weight.cwiseProduct(e);
  }

  const StereoCamera& camera_;
  std::span<const PoseObservation> observations_;
  const std::optional<PosePrior>& prior_;
  std::vector<char> usable_, inlier_;
};

// The problem at a pose, as levenberg_marquardt.h wants it. Costs and equations come from one evaluation.
class PoseSearch {
 public:
  PoseSearch(const Problem& problem, SE3& T_cw, bool robust)
      : problem_(problem), T_cw_(T_cw), robust_(robust) {}

  double cost() {
    at_ = problem_.evaluate(T_cw_, robust_);
    return at_.cost;
  }
  void linearize() {}
  bool solve(double lambda) {
    Matrix6d damped = at_.H;
    damped.diagonal() *= 1.0 + lambda;
    damped.diagonal().array() += 1e-9;
    step_ = -damped.ldlt().solve(at_.g);
    return step_.allFinite();
  }
  double trial_cost() {
    moved_ = SE3::exp(step_) * T_cw_;
    there_ = problem_.evaluate(moved_, robust_);
    return there_.cost;
  }
  void accept() {
    T_cw_ = moved_;
    at_ = there_;
  }
  Matrix6d information() const { return at_.H.selfadjointView<Eigen::Lower>(); }

 private:
  const Problem& problem_;
  SE3& T_cw_;
  const bool robust_;
  SE3 moved_;
  Vector6d step_;
  NormalEquations at_, there_;
};

PoseEstimate optimize(const StereoCamera& camera, const SE3& initial,
                      std::span<const PoseObservation> observations, const std::optional<PosePrior>& prior,
                      const std::vector<char>* begin_with) {
  const PoseEstimate failed{initial, std::vector<char>(observations.size(), 0), 0, Matrix6d::Zero()};
  if (observations.size() < 3 || !initial.is_finite()) return failed;
  Problem problem(camera, observations, prior);
  if (begin_with != nullptr) problem.begin_with(*begin_with);
  SE3 T_cw = initial;
  int inliers = 0;
  Matrix6d information = Matrix6d::Zero();
  for (int round = 0; round < kPoseRounds; ++round) {
    PoseSearch search(problem, T_cw, round + 1 < kPoseRounds);
    levenberg_marquardt(search, kDamping);
    information = search.information();
    inliers = problem.classify(T_cw);
    if (inliers < 3) return failed;
  }
  T_cw.normalize();
  if (!T_cw.is_finite()) return failed;
  return {T_cw, problem.inlier(), inliers, information};
}

}  // namespace

PoseEstimate optimize_pose(const StereoCamera& camera, const SE3& initial,
                           std::span<const PoseObservation> observations,
                           const std::optional<PosePrior>& prior) {
  return optimize(camera, initial, observations, prior, nullptr);
}

PoseEstimate optimize_pose(const StereoCamera& camera, const PnpResult& initial,
                           std::span<const PoseObservation> observations) {
  return optimize(camera, initial.T_cw, observations, std::nullopt, &initial.inlier);
}

}  // namespace penumbra::slam
