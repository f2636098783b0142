#include "slam/evaluation/alignment.h"

#include <Eigen/SVD>
#include <cmath>

#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

// A singular value below this fraction of the largest (or of rounding error) counts as 0.
constexpr double kRankTolerance = 1e-12;

// The rotation R that maximises trace(R^T Sigma), and trace(D S) of it.
struct BestRotation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double trace = 0.0;
  bool is_unique = false;
};

BestRotation best_rotation(const Eigen::Matrix3d& covariance, double largest_possible) {
  BestRotation best;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d = svd.singularValues();
  if (!(d[0] > kRankTolerance * largest_possible)) return best;
  const Eigen::Matrix3d &U = svd.matrixU(), &V = svd.matrixV();
  if (d[1] <= kRankTolerance * d[0]) {
    best.rotation = Eigen::Quaterniond::FromTwoVectors(V.col(0), U.col(0)).toRotationMatrix();
    best.trace = d[0];
    return best;
  }
  const Eigen::Vector3d S(1.0, 1.0, U.determinant() * V.determinant() < 0.0 ? -1.0 : 1.0);
  best.rotation = U * S.asDiagonal() * V.transpose();
  best.trace = d.dot(S);
  best.is_unique = true;
  return best;
}

}  // namespace

Alignment parse_alignment(std::string_view name) {
  for (const Alignment alignment : {Alignment::none, Alignment::se3, Alignment::sim3}) {
    if (name == to_string(alignment)) return alignment;
  }
  throw UsageError(fmt::format("alignment '{}': expected none, se3 or sim3", name));
}

const char* to_string(Alignment alignment) {
  switch (alignment) {
    case Alignment::none:
      return "none";
    case Alignment::se3:
      return "se3";
    default:
      return "sim3";
  }
}

Similarity find_alignment(const Trajectory& reference, const Trajectory& estimate, Alignment alignment) {
  require_paired(reference, estimate, 1);
  Similarity result;
  if (alignment == Alignment::none) return result;

  const auto n = static_cast<double>(reference.size());
  Eigen::Vector3d mean_x = Eigen::Vector3d::Zero(), mean_y = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < reference.size(); ++i) {
    mean_x += estimate[i].T_wc.translation / n;
    mean_y += reference[i].T_wc.translation / n;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance_x = 0.0, variance_y = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Eigen::Vector3d x = estimate[i].T_wc.translation - mean_x;
    const Eigen::Vector3d y = reference[i].T_wc.translation - mean_y;
    covariance += y * x.transpose() / n;
    variance_x += x.squaredNorm() / n;
    variance_y += y.squaredNorm() / n;
  }
  const double largest_possible = std::sqrt(variance_x * variance_y);
  const BestRotation best = best_rotation(covariance, largest_possible);
  result.rotation = best.rotation;
  result.is_unique = best.is_unique;
  if (alignment == Alignment::sim3 && best.trace > 0.0) result.scale = best.trace / variance_x;
  result.translation = mean_y - result.scale * (result.rotation * mean_x);
  return result;
}

Trajectory transformed(const Trajectory& trajectory, const Similarity& alignment) {
  Trajectory moved = trajectory;
  for (TimedPose& pose : moved) {
    pose.T_wc = {alignment.rotation * pose.T_wc.rotation, alignment * pose.T_wc.translation};
  }
  return moved;
}

void require_paired(const Trajectory& reference, const Trajectory& estimate, int minimum) {
  if (reference.size() != estimate.size()) {
    throw InputError("ground truth and estimate", counted(reference.size(), "pose") + " each",
                     counted(estimate.size(), "pose") + " in the estimate");
  }
  if (reference.size() < static_cast<std::size_t>(minimum)) {
    throw InputError("ground truth and estimate", fmt::format("at least {} paired poses", minimum),
                     fmt::format("{}", reference.size()));
  }
}

}  // namespace penumbra::slam
