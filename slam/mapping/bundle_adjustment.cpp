#include "slam/mapping/bundle_adjustment.h"

#include <algorithm>
#include <array>
#include <future>
#include <limits>
#include <memory>

#include "slam/mapping/reduced_camera_system.h"

namespace penumbra::slam {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

constexpr double kNearest = 0.05;    // metres in front of the camera
constexpr double kBehindCost = 100;  // cost, in gates, of a point behind the camera
constexpr double kMaxLambda = 1e8;

// The row and column of the disparity offset in the equations of the poses.
struct Border {
  Eigen::VectorXd s;            // per pose
  double c = 0.0, right = 0.0;  // its own diagonal and right side

  explicit Border(int free_poses = 0) : s(Eigen::VectorXd::Zero(6 * free_poses)) {}
  void add(const Border& other) {
    s += other.s;
    c += other.c;
    right += other.right;
  }
};

// What one part of the points contributes to the sums over all.
struct Part {
  std::size_t begin = 0, end = 0;  // points
  double cost = 0.0;
  std::vector<Matrix6d> U;
  Eigen::VectorXd g_poses, right;
  Border border, eliminated;  // before the points are eliminated, and what that changes
};

class Solver {
 public:
  Solver(const BundleProblem& problem, bool robust, int threads)
      : problem_(problem),
        robust_(robust),
        threads_(problem.observations.size() < kBundleWorthThreads ? 1
                                                                   : std::clamp(threads, 1, kBundleParts)) {
    for (const char fixed : problem.pose_fixed) slot_.push_back(fixed ? -1 : free_poses_++);
    const std::size_t points = problem.points.size();
    V_.resize(points);
    V_inverse_.resize(points);
    g_points_.resize(points);
    offset_points_.resize(points);
    W_.resize(problem.observations.size());
    begin_.assign(points + 1, 0);
    for (const BundleObservation& o : problem.observations) ++begin_[static_cast<std::size_t>(o.point) + 1];
    for (std::size_t j = 1; j < begin_.size(); ++j) begin_[j] += begin_[j - 1];
    reduced_ = std::make_unique<ReducedCameraSystem>(free_poses_, neighbours(), kBundleParts);
    // Parts of about equally many observations.
    const int observations = begin_.back();
    for (int p = 0; p < kBundleParts; ++p) {
      const auto first_beyond = [&](int share) {
        return static_cast<std::size_t>(
            std::lower_bound(begin_.begin(), begin_.end() - 1, observations / kBundleParts * share) -
            begin_.begin());
      };
      parts_[std::size_t(p)].begin = p == 0 ? 0 : parts_[std::size_t(p) - 1].end;
      parts_[std::size_t(p)].end = p + 1 == kBundleParts ? points : first_beyond(p + 1);
    }
  }

  double cost(const StereoCamera& camera, const std::vector<SE3>& poses,
              const std::vector<Eigen::Vector3d>& points) {
    for_each_part([&](Part& part, int) {
      part.cost = 0.0;
      for (int i = begin_[part.begin]; i < begin_[part.end]; ++i) {
        const BundleObservation& o = problem_.observations[std::size_t(i)];
        if (!o.active) continue;
        const PixelMeasurement& z = o.measurement;
        const Eigen::Vector3d p = poses[std::size_t(o.pose)] * points[std::size_t(o.point)];
        part.cost +=
            p.z() < kNearest
                ? kBehindCost * z.gate()
                : huber(reprojection_error(camera, p, z).squaredNorm() * z.inverse_variance, bound(z)).cost;
      }
    });
    double sum = prior() * camera.disparity_offset * camera.disparity_offset;
    for (const Part& part : parts_) sum += part.cost;
    return sum;
  }

  // U, V, W and the gradients at the problem's present state.
  void linearize() {
    for_each_part([&](Part& part, int) {
      part.U.assign(static_cast<std::size_t>(free_poses_), Matrix6d::Zero());
      part.g_poses = Eigen::VectorXd::Zero(6 * free_poses_);
      part.border = Border(free_poses_);
      for (std::size_t j = part.begin; j < part.end; ++j) {
        V_[j].setZero();
        g_points_[j].setZero();
        offset_points_[j].setZero();
        for (int i = begin_[j]; i < begin_[j + 1]; ++i) linearize(static_cast<std::size_t>(i), j, part);
      }
    });
    U_.assign(static_cast<std::size_t>(free_poses_), Matrix6d::Zero());
    g_poses_ = Eigen::VectorXd::Zero(6 * free_poses_);
    border_ = Border(free_poses_);
    border_.c = prior();
    border_.right = -prior() * problem_.camera.disparity_offset;
    for (const Part& part : parts_) {
      for (std::size_t a = 0; a < U_.size(); ++a) U_[a] += part.U[a];
      g_poses_ += part.g_poses;
      border_.add(part.border);
    }
  }

  // Solves the damped equations; false where they are singular.
  bool solve(double lambda, BundleStep& step) {
    for_each_part([&](Part& part, int number) {
      reduced_->set_zero(number);
      part.right = Eigen::VectorXd::Zero(6 * free_poses_);
      part.eliminated = Border(free_poses_);
      for (std::size_t j = part.begin; j < part.end; ++j) eliminate(j, lambda, part, number);
    });
    Eigen::VectorXd right = -g_poses_;
    Border border = border_;
    border.c *= 1.0 + lambda;
    for (const Part& part : parts_) {
      right += part.right;
      border.add(part.eliminated);
    }
    for (int a = 0; a < free_poses_; ++a) {
      Matrix6d U = U_[std::size_t(a)];
      U.diagonal() *= 1.0 + lambda;
      reduced_->block(a, a) += U;
    }
    if (!reduced_->factorise()) return false;
    Eigen::VectorXd dx = reduced_->solve(right);
    step.disparity_offset = 0.0;
    if (adjusts_offset()) {
      const Eigen::VectorXd y = reduced_->solve(border.s);
      const double reduced = border.c - border.s.dot(y);
      if (!(reduced > 0.0)) return false;
      step.disparity_offset = (border.right - border.s.dot(dx)) / reduced;
      dx -= y * step.disparity_offset;
    }
    if (!dx.allFinite()) return false;

    step.poses.assign(slot_.size(), Vector6d::Zero());
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] >= 0) step.poses[i] = dx.segment<6>(6 * slot_[i]);
    }
    step.points.resize(V_.size());
    for_each_part([&](Part& part, int) {
      for (std::size_t j = part.begin; j < part.end; ++j)
        step.points[j] = point_step(j, dx, step.disparity_offset);
    });
    return std::all_of(step.points.begin(), step.points.end(),
                       [](const Eigen::Vector3d& X) { return X.allFinite(); });
  }

 private:
  template <typename Work>
  void for_each_part(Work&& work) {
    const auto share = [&](int thread) {
      for (int p = thread; p < kBundleParts; p += threads_) work(parts_[static_cast<std::size_t>(p)], p);
    };
    std::vector<std::future<void>> others;
    for (int t = 1; t < threads_; ++t) others.push_back(std::async(std::launch::async, share, t));
    share(0);
    for (std::future<void>& other : others) other.get();
  }

  bool adjusts_offset() const { return problem_.disparity_offset_sigma > 0.0; }
  // 1/pixels^2
  double prior() const {
    const double sigma = problem_.disparity_offset_sigma;
    return adjusts_offset() ? 1.0 / (sigma * sigma) : 0.0;
  }

  double bound(const PixelMeasurement& z) const {
    return robust_ ? z.gate() : std::numeric_limits<double>::infinity();
  }

  // Slot of the observation's pose among the free ones; -1 for a fixed pose or an observation that is left
  // out.
  int free_slot(std::size_t i) const {
    const BundleObservation& o = problem_.observations[i];
    return o.active ? slot_[std::size_t(o.pose)] : -1;
  }

  void linearize(std::size_t i, std::size_t j, Part& part) {
    const BundleObservation& o = problem_.observations[i];
    W_[i].setZero();
    if (!o.active) return;
    const PixelMeasurement& z = o.measurement;
    const SE3& T_cw = problem_.poses[std::size_t(o.pose)];
    const Eigen::Vector3d p = T_cw * problem_.points[j];
    if (p.z() < kNearest) return;
    const Eigen::Vector3d e = reprojection_error(problem_.camera, p, z);
    const double weight = huber(e.squaredNorm() * z.inverse_variance, bound(z)).weight * z.inverse_variance;
    const Eigen::Matrix3d J_pi = projection_jacobian(problem_.camera, p, z.stereo);
    const Eigen::Matrix3d J_point = J_pi * T_cw.rotation;
    V_[j].noalias() += weight * J_point.transpose() * J_point;
    g_points_[j].noalias() += weight * J_point.transpose() * e;
    const bool offset = adjusts_offset() && z.stereo;
    if (offset) {
      offset_points_[j].noalias() -= weight * J_point.row(2).transpose();
      part.border.c += weight;
      part.border.right += weight * e.z();
    }
    const int a = slot_[std::size_t(o.pose)];
    if (a < 0) return;
    const Eigen::Matrix<double, 3, 6> J_pose = pose_jacobian(J_pi, p);
    part.U[std::size_t(a)].noalias() += weight * J_pose.transpose() * J_pose;
    part.g_poses.segment<6>(6 * a).noalias() += weight * J_pose.transpose() * e;
    if (offset) part.border.s.segment<6>(6 * a).noalias() -= weight * J_pose.row(2).transpose();
    W_[i].noalias() = weight * J_pose.transpose() * J_point;
  }

  // Per free pose the free poses behind it with which it shares a point; empty where nobody needs to know.
  std::vector<std::vector<int>> neighbours() const {
    if (free_poses_ <= ReducedCameraSystem::kDensePoses) return {};
    std::vector<std::vector<int>> behind(static_cast<std::size_t>(free_poses_));
    std::vector<int> seen_by;
    for (std::size_t j = 0; j + 1 < begin_.size(); ++j) {
      seen_by.clear();
      for (int i = begin_[j]; i < begin_[j + 1]; ++i) {
        const int a = free_slot(static_cast<std::size_t>(i));
        if (a >= 0) seen_by.push_back(a);
      }
      for (const int a : seen_by) {
        for (const int b : seen_by) {
          if (b > a) behind[static_cast<std::size_t>(a)].push_back(b);
        }
      }
      // Keeps the lists short while they grow.
      for (const int a : seen_by) {
        std::vector<int>& row = behind[static_cast<std::size_t>(a)];
        if (row.size() < 4096) continue;
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
      }
    }
    return behind;
  }

  // Takes point j out of the equations of the poses.
  void eliminate(std::size_t j, double lambda, Part& part, int number) {
    Eigen::Matrix3d V = V_[j];
    V.diagonal() *= 1.0 + lambda;
    // A direction that nothing measures (a point that is not seen, say) stays where it is.
    V.diagonal().array() += 1e-9;
    V_inverse_[j] = V.inverse();
    if (adjusts_offset()) {
      const Eigen::Vector3d y = V_inverse_[j] * offset_points_[j];
      part.eliminated.c -= y.dot(offset_points_[j]);
      part.eliminated.right += y.dot(g_points_[j]);
    }
    for (int i = begin_[j]; i < begin_[j + 1]; ++i) {
      const int a = free_slot(std::size_t(i));
      if (a < 0) continue;
      const Matrix63 Y = W_[std::size_t(i)] * V_inverse_[j];
      part.right.segment<6>(6 * a).noalias() += Y * g_points_[j];
      if (adjusts_offset()) part.eliminated.s.segment<6>(6 * a).noalias() -= Y * offset_points_[j];
      for (int k = begin_[j]; k < begin_[j + 1]; ++k) {
        const int b = free_slot(std::size_t(k));
        if (b >= a) reduced_->block(a, b, number).noalias() -= Y * W_[std::size_t(k)].transpose();
      }
    }
  }

  // dX of point j, given dx and dd0.
  Eigen::Vector3d point_step(std::size_t j, const Eigen::VectorXd& dx, double disparity_offset) const {
    Eigen::Vector3d sum = g_points_[j] + offset_points_[j] * disparity_offset;
    for (int i = begin_[j]; i < begin_[j + 1]; ++i) {
      const int a = free_slot(static_cast<std::size_t>(i));
      if (a >= 0) sum.noalias() += W_[std::size_t(i)].transpose() * dx.segment<6>(6 * a);
    }
    return -(V_inverse_[j] * sum);
  }

  const BundleProblem& problem_;
  const bool robust_;
  const int threads_;
  int free_poses_ = 0;
  std::vector<int> slot_;   // pose -> place among the free ones; -1 where it is fixed
  std::vector<int> begin_;  // point -> its first observation; one more at the end
  std::vector<Matrix6d> U_;
  std::vector<Eigen::Matrix3d> V_, V_inverse_;
  std::vector<Matrix63> W_;  // per observation
  std::unique_ptr<ReducedCameraSystem> reduced_;
  std::array<Part, kBundleParts> parts_;
  Eigen::VectorXd g_poses_;
  std::vector<Eigen::Vector3d> g_points_;
  std::vector<Eigen::Vector3d> offset_points_;  // per point: the disparity offset's block beside V
  Border border_;
};

}  // namespace

BundleSummary solve_bundle(BundleProblem& problem, const BundleSettings& settings) {
  Solver solver(problem, settings.robust, settings.threads);
  BundleSummary summary;
  summary.initial_cost = summary.final_cost = solver.cost(problem.camera, problem.poses, problem.points);
  double lambda = settings.initial_lambda;
  BundleStep step;
  bool linearized = false;
  while (summary.iterations < settings.iterations && lambda < kMaxLambda) {
    if (settings.stop != nullptr && settings.stop->load(std::memory_order_relaxed)) break;
    ++summary.iterations;
    if (!linearized) solver.linearize();
    linearized = true;
    if (!solver.solve(lambda, step)) {
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
    const double cost = solver.cost(camera, poses, points);
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

BundleStep bundle_step(const BundleProblem& problem, bool robust, double lambda) {
  Solver solver(problem, robust, 1);
  solver.linearize();
  BundleStep step;
  if (!solver.solve(lambda, step)) return {};
  return step;
}

}  // namespace penumbra::slam
