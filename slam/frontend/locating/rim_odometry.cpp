#include "slam/frontend/locating/rim_odometry.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/measurement.h"

namespace penumbra::slam {

namespace {

constexpr float kRimBand = 8.0F;                          // pixels: rows that are looked at together
constexpr float kRimMargin = 8.0F;                        // pixels beside what moves
constexpr double kNearestRim = 1.5;                       // metres
constexpr float kFarthestU = 150.0F, kFarthestV = 60.0F;  // pixels that a feature can have moved
constexpr int kTurnsTried = 8;                            // to each side ...
constexpr double kTurnStep = 0.01;                        // ... radians each
// Sideways the way and the turn look much the same, and the way is kept as it is expected: so it may hardly
// give way. Not at all would be worse, as what it is wrong by would all go into the turn.
constexpr double kWayShare = 0.4;  // of the expected way's deviation
constexpr int kRimIterations = 10;

// Per band of rows the columns from the first to the last feature on what moves.
class CoveredRows {
 public:
  void add(float u, float v) {
    const std::size_t at = band(v);
    if (at >= rows_.size()) rows_.resize(at + 1);
    rows_[at].from = std::min(rows_[at].from, u);
    rows_[at].to = std::max(rows_[at].to, u);
  }
  bool covers(float u, float v) const {
    const std::size_t at = band(v);
    for (std::size_t b = at > 0 ? at - 1 : 0; b <= at + 1 && b < rows_.size(); ++b) {
      if (u >= rows_[b].from - kRimMargin && u <= rows_[b].to + kRimMargin) return true;
    }
    return false;
  }

 private:
  struct Columns {
    float from = std::numeric_limits<float>::infinity(), to = -std::numeric_limits<float>::infinity();
  };
  static std::size_t band(float v) { return static_cast<std::size_t>(std::max(0.0F, v) / kRimBand); }
  std::vector<Columns> rows_;
};

struct RimPair {
  Eigen::Vector3d first;          // ray of the one, z = 1
  Eigen::Vector2d second;         // of the other
  double inverse_depth = -1.0;    // 1/metres; negative: unknown
  double inverse_variance = 1.0;  // of e, 1/pixels^2
  bool right = false;
};

class RimProblem {
 public:
  RimProblem(const StereoCamera& camera, const PosePrior& expected) : camera_(camera), expected_(expected) {}

  void add_pairs(const Features& before, const Features& now, std::span<const float> depth,
                 std::span<const double> scales, bool right) {
    const double shift = right ? camera_.disparity_offset : 0.0;
    const auto ray = [&](const Keypoint& k) {
      return Eigen::Vector2d((k.u + shift - camera_.cx) / camera_.fx, (k.v - camera_.cy) / camera_.fy);
    };
    for (const Match& match : match_descriptors(before.descriptors, now.descriptors, {})) {
      const auto a = static_cast<std::size_t>(match.source), b = static_cast<std::size_t>(match.feature);
      const Keypoint &k1 = before.keypoints[a], &k2 = now.keypoints[b];
      if (std::abs(k1.level - k2.level) > 1 || std::abs(k1.u - k2.u) > kFarthestU ||
          std::abs(k1.v - k2.v) > kFarthestV)
        continue;
      const double sigma = kCornerSigma * std::hypot(scales[static_cast<std::size_t>(k1.level)],
                                                     scales[static_cast<std::size_t>(k2.level)]);
      RimPair pair{ray(k1).homogeneous(), ray(k2), -1.0, 1.0 / (sigma * sigma), right};
      if (!right && depth[a] > 0.0F) pair.inverse_depth = 1.0 / depth[a];
      pairs_.push_back(pair);
    }
  }
  int pairs() const { return static_cast<int>(pairs_.size()); }

  // e of a pair, pixels.
  Eigen::Vector2d error(const RimPair& pair, const SE3& T) const {
    const Eigen::Vector3d y = T.rotation * pair.first;
    Eigen::Vector3d t = T.translation;
    if (pair.right) t += camera_.baseline * (T.rotation.col(0) - Eigen::Vector3d::UnitX());
    double w = pair.inverse_depth;
    if (w < 0.0) {
      // (y_z + w t_z) x2 = y_xy + w t_xy, in w.
      const Eigen::Vector2d a = y.z() * pair.second - y.head<2>(), b = t.z() * pair.second - t.head<2>();
      w = std::clamp(-a.dot(b) / std::max(1e-12, b.squaredNorm()), 0.0, 1.0 / kNearestRim);
    }
    const Eigen::Vector3d p = y + w * t;
    if (p.z() < 1e-3) return Eigen::Vector2d::Constant(1e3);
    return camera_.fx * (p.head<2>() / p.z() - pair.second);
  }

  double truncated_cost(const SE3& T) const {
    double cost = prior_error(T).squaredNorm();
    for (const RimPair& pair : pairs_)
      cost += std::min(kChiSquare2, error(pair, T).squaredNorm() * pair.inverse_variance);
    return cost;
  }
  int inliers(const SE3& T) const {
    return static_cast<int>(std::count_if(pairs_.begin(), pairs_.end(), [&](const RimPair& pair) {
      return error(pair, T).squaredNorm() * pair.inverse_variance <= kChiSquare2;
    }));
  }

  // One Gauss-Newton step over what agrees, robust; derivatives are differences.
  std::optional<SE3> improved(const SE3& T) const {
    constexpr double kStep = 1e-6;
    std::array<SE3, 6> moved;
    for (int k = 0; k < 6; ++k) moved[static_cast<std::size_t>(k)] = SE3::exp(kStep * Vector6d::Unit(k)) * T;
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    const auto add = [&](const auto& e, const auto& J, double weight) {
      H.noalias() += weight * J.transpose() * J;
      g.noalias() += weight * J.transpose() * e;
    };
    const Vector6d prior = prior_error(T);
    Matrix6d J_prior;
    for (int k = 0; k < 6; ++k)
      J_prior.col(k) = (prior_error(moved[static_cast<std::size_t>(k)]) - prior) / kStep;
    add(prior, J_prior, 1.0);
    for (const RimPair& pair : pairs_) {
      const Eigen::Vector2d e = error(pair, T);
      const double s = e.squaredNorm() * pair.inverse_variance;
      if (s > 4.0 * kChiSquare2) continue;
      Eigen::Matrix<double, 2, 6> J;
      for (int k = 0; k < 6; ++k) J.col(k) = (error(pair, moved[static_cast<std::size_t>(k)]) - e) / kStep;
      add(e, J, huber(s, 1.0).weight * pair.inverse_variance);
    }
    const Vector6d step = -H.ldlt().solve(g);
    if (!step.allFinite()) return std::nullopt;
    return SE3::exp(step) * T;
  }

 private:
  Vector6d prior_error(const SE3& T) const {
    Vector6d e = (T * expected_.T_cw.inverse()).log();
    e.head<3>() /= kWayShare * expected_.metres;
    e.tail<3>() /= expected_.radians;
    return e;
  }

  const StereoCamera& camera_;
  const PosePrior& expected_;
  std::vector<RimPair> pairs_;
};

}  // namespace

void collect_rim(const FeatureView& features, const Features& right, RimView& rim) {
  rim.clear();
  CoveredRows left_rows, right_rows;
  for (int i = 0; i < features.size(); ++i) {
    if (!features.is_movable(i)) continue;
    const FeaturePixel pixel = features.pixel(i);
    left_rows.add(pixel.u, pixel.v);
    if (features.has_stereo(i)) right_rows.add(pixel.u_right, pixel.v);
  }
  for (int i = 0; i < features.size(); ++i) {
    const FeaturePixel pixel = features.pixel(i);
    if (left_rows.covers(pixel.u, pixel.v)) continue;
    rim.left.keypoints.push_back(features.keypoint(i));
    rim.left.descriptors.push_back(features.descriptor(i));
    rim.depth.push_back(features.depth(i));
  }
  for (std::size_t j = 0; j < right.keypoints.size(); ++j) {
    if (right_rows.covers(right.keypoints[j].u, right.keypoints[j].v)) continue;
    rim.right.keypoints.push_back(right.keypoints[j]);
    rim.right.descriptors.push_back(right.descriptors[j]);
  }
}

std::optional<SE3> rim_step(const StereoCamera& camera, std::span<const double> scales, const RimView& before,
                            const RimView& now, const PosePrior& expected, const RimSettings& settings) {
  RimProblem problem(camera, expected);
  problem.add_pairs(before.left, now.left, before.depth, scales, /*right=*/false);
  problem.add_pairs(before.right, now.right, {}, scales, /*right=*/true);
  if (problem.pairs() < settings.fewest_inliers) return std::nullopt;
  SE3 best = expected.T_cw;
  double lowest = std::numeric_limits<double>::infinity();
  for (int k = -kTurnsTried; k <= kTurnsTried; ++k) {
    SE3 turned = expected.T_cw;
    turned.rotation = so3_exp({0.0, k * kTurnStep, 0.0}) * turned.rotation;
    const double cost = problem.truncated_cost(turned);
    if (cost >= lowest) continue;
    lowest = cost;
    best = turned;
  }
  for (int i = 0; i < kRimIterations; ++i) {
    const std::optional<SE3> next = problem.improved(best);
    if (!next) return std::nullopt;
    best = *next;
  }
  best.normalize();
  best.translation = expected.T_cw.translation;
  const int agreeing = problem.inliers(best);
  if (!best.is_finite() || agreeing < settings.fewest_inliers ||
      agreeing < settings.least_agreeing * problem.pairs()) {
    return std::nullopt;
  }
  return best;
}

}  // namespace penumbra::slam
