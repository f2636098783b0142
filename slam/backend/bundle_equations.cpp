#include "slam/backend/bundle_equations.h"

#include <algorithm>
#include <future>
#include <limits>

#include "slam/backend/block_products.h"
#include "slam/geometry/pose_equations.h"

namespace penumbra::slam {

namespace {

constexpr double kNearest = 0.05;    // metres in front of the camera
constexpr double kBehindCost = 100;  // cost, in gates, of a point behind the camera

// J_pi R: a row of J_pi has two entries that are not 0.
Eigen::Matrix3d times_rotation(const Eigen::Matrix3d& J_pi, const Eigen::Matrix3d& R) {
  Eigen::Matrix3d product;
  product.row(0) = J_pi(0, 0) * R.row(0) + J_pi(0, 2) * R.row(2);
  product.row(1) = J_pi(1, 1) * R.row(1) + J_pi(1, 2) * R.row(2);
  product.row(2) = J_pi(2, 0) * R.row(0) + J_pi(2, 2) * R.row(2);
  return product;
}

}  // namespace

template <typename Work>
void BundleEquations::for_each_part(Work&& work) {
  const auto share = [&](int thread) {
    for (int p = thread; p < kBundleParts; p += threads_) work(parts_[static_cast<std::size_t>(p)], p);
  };
  std::vector<std::future<void>> others;
  for (int t = 1; t < threads_; ++t) others.push_back(std::async(std::launch::async, share, t));
  share(0);
  for (std::future<void>& other : others) other.get();
}

BundleEquations::BundleEquations(const BundleProblem& problem, bool robust, int threads)
    : problem_(problem),
      robust_(robust),
      threads_(problem.observations.size() < kBundleWorthThreads ? 1 : std::clamp(threads, 1, kBundleParts)) {
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

double BundleEquations::cost(const StereoCamera& camera, const std::vector<SE3>& poses,
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

void BundleEquations::linearize() {
  for_each_part([&](Part& part, int) {
    part.U.assign(static_cast<std::size_t>(free_poses_), Matrix6d::Zero());
    part.g_poses = Eigen::VectorXd::Zero(6 * free_poses_);
    part.border = Border(free_poses_);
    for (std::size_t j = part.begin; j < part.end; ++j) {
      V_[j].setZero();
      g_points_[j].setZero();
      offset_points_[j].setZero();
      for (int i = begin_[j]; i < begin_[j + 1]; ++i)
        linearize_observation(static_cast<std::size_t>(i), j, part);
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

bool BundleEquations::solve(double lambda, BundleStep& step) {
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
    const double information = border.c - border.s.dot(y);
    if (!(information > 0.0)) return false;
    step.disparity_offset = (border.right - border.s.dot(dx)) / information;
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

double BundleEquations::prior() const {
  const double sigma = problem_.disparity_offset_sigma;
  return adjusts_offset() ? 1.0 / (sigma * sigma) : 0.0;
}

double BundleEquations::bound(const PixelMeasurement& z) const {
  return robust_ ? z.gate() : std::numeric_limits<double>::infinity();
}

int BundleEquations::free_slot(std::size_t i) const {
  const BundleObservation& o = problem_.observations[i];
  return o.active ? slot_[std::size_t(o.pose)] : -1;
}

void BundleEquations::linearize_observation(std::size_t i, std::size_t j, Part& part) {
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
  const Eigen::Matrix3d J_point = times_rotation(J_pi, T_cw.rotation);
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
  const PoseEquations pose(J_pi, p, weight);
  pose.add_upper_hessian(part.U[std::size_t(a)].data());
  pose.add_gradient(e, part.g_poses.data() + 6 * a);
  if (offset) part.border.s.segment<6>(6 * a) -= pose.weighted_right_row();
  W_[i] = pose.cross(J_point);
}

std::vector<std::vector<int>> BundleEquations::neighbours() const {
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

void BundleEquations::eliminate(std::size_t j, double lambda, Part& part, int number) {
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
  const int first = begin_[j], count = begin_[j + 1] - first;
  const Matrix63* W = W_.data() + first;
  thread_local std::vector<int> slots;  // of the point's observations; for its memory
  slots.clear();
  for (int k = 0; k < count; ++k) slots.push_back(free_slot(std::size_t(first + k)));
  for (int i = 0; i < count; ++i) {
    const int a = slots[std::size_t(i)];
    if (a < 0) continue;
    const Matrix63 Y = W[i] * V_inverse_[j];
    part.right.segment<6>(6 * a).noalias() += Y * g_points_[j];
    if (adjusts_offset()) part.eliminated.s.segment<6>(6 * a).noalias() -= Y * offset_points_[j];
    if (!reduced_->sparse()) {
      auto corner = reduced_->block(0, 0, number);
      subtract_products({corner.data(), corner.outerStride()}, a, Y, W, slots);
      continue;
    }
    for (int k = 0; k < count; ++k) {
      const int b = slots[std::size_t(k)];
      if (b >= a) reduced_->block(a, b, number).noalias() -= Y * W[k].transpose();
    }
  }
}

Eigen::Vector3d BundleEquations::point_step(std::size_t j, const Eigen::VectorXd& dx,
                                            double disparity_offset) const {
  Eigen::Vector3d sum = g_points_[j] + offset_points_[j] * disparity_offset;
  for (int i = begin_[j]; i < begin_[j + 1]; ++i) {
    const int a = free_slot(static_cast<std::size_t>(i));
    if (a >= 0) sum.noalias() += W_[std::size_t(i)].transpose() * dx.segment<6>(6 * a);
  }
  return -(V_inverse_[j] * sum);
}

}  // namespace penumbra::slam
