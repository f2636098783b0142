#include "slam/geometry/fundamental.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kPairs = 8;  // that determine F
constexpr int kRefinements = 2;

// Moves and scales points to mean 0 and mean distance sqrt(2); scale 0 where they coincide.
struct Normalisation {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double scale = 0.0;

  template <class PointOf>
  Normalisation(std::span<const PointPair> pairs, PointOf&& point) {
    for (const PointPair& pair : pairs) mean += point(pair);
    mean /= static_cast<double>(pairs.size());
    double distance = 0.0;
    for (const PointPair& pair : pairs) distance += (point(pair) - mean).norm();
    if (distance > 1e-9) scale = std::sqrt(2.0) * static_cast<double>(pairs.size()) / distance;
  }
  Eigen::Vector3d operator()(const Eigen::Vector2d& p) const { return ((p - mean) * scale).homogeneous(); }
  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d m = Eigen::Vector3d(scale, scale, 1.0).asDiagonal();
    m.topRightCorner<2, 1>() = -scale * mean;
    return m;
  }
};

std::array<std::size_t, kPairs> draw_pairs(std::uint64_t seed, std::uint64_t draw, std::size_t n) {
  std::array<std::size_t, kPairs> drawn{};
  std::uint64_t counter = draw << 16U;
  for (std::size_t k = 0; k < kPairs;) {
    drawn[k] = static_cast<std::size_t>(counter_random(seed, counter++) % n);
    bool repeated = false;
    for (std::size_t earlier = 0; earlier < k; ++earlier) repeated = repeated || drawn[earlier] == drawn[k];
    if (!repeated) ++k;
  }
  return drawn;
}

int mark_inliers(std::span<const PointPair> pairs, const Eigen::Matrix3d& F, double threshold,
                 std::vector<char>& inlier) {
  inlier.resize(pairs.size());
  int count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    inlier[i] = sampson_distance(F, pairs[i]) < threshold;
    count += inlier[i];
  }
  return count;
}

}  // namespace

std::optional<Eigen::Matrix3d> solve_fundamental(std::span<const PointPair> pairs) {
  if (pairs.size() < kPairs) return std::nullopt;
  const Normalisation first(pairs, [](const PointPair& p) { return p.first; });
  const Normalisation second(pairs, [](const PointPair& p) { return p.second; });
  if (first.scale == 0.0 || second.scale == 0.0) return std::nullopt;
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d x = first(pair.first), y = second(pair.second);
    Eigen::Matrix<double, 9, 1> row;
    row << y.x() * x, y.y() * x, x;
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  const Eigen::Matrix<double, 9, 1> f = eigen.eigenvectors().col(0);
  Eigen::Matrix3d F;
  F << f.segment<3>(0).transpose(), f.segment<3>(3).transpose(), f.segment<3>(6).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d values = svd.singularValues();
  values.z() = 0.0;
  F = second.matrix().transpose() * (svd.matrixU() * values.asDiagonal() * svd.matrixV().transpose()) *
      first.matrix();
  const double size = F.norm();
  if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
  return F / size;
}

std::optional<FundamentalResult> find_fundamental(std::span<const PointPair> pairs,
                                                  const FundamentalSettings& settings) {
  const std::size_t n = pairs.size();
  if (n < kPairs) return std::nullopt;
  FundamentalResult best;
  std::vector<char> inlier;
  double needed = settings.most_draws;
  for (int draw = 0; draw < settings.most_draws && draw < needed; ++draw) {
    std::array<PointPair, kPairs> sample;
    const auto drawn = draw_pairs(settings.seed, static_cast<std::uint64_t>(draw), n);
    for (std::size_t k = 0; k < kPairs; ++k) sample[k] = pairs[drawn[k]];
    const std::optional<Eigen::Matrix3d> F = solve_fundamental(sample);
    if (!F) continue;
    const int count = mark_inliers(pairs, *F, settings.threshold, inlier);
    if (count <= best.inliers) continue;
    best = {*F, inlier, count};
    const double all_good = std::pow(static_cast<double>(count) / static_cast<double>(n), kPairs);
    needed = all_good < 1.0 ? std::log(1.0 - settings.confidence) / std::log1p(-all_good) : 1.0;
  }
  if (best.inliers < static_cast<int>(kPairs)) return std::nullopt;
  std::vector<PointPair> good;
  for (int round = 0; round < kRefinements; ++round) {
    good.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (best.inlier[i] != 0) good.push_back(pairs[i]);
    }
    const std::optional<Eigen::Matrix3d> F = solve_fundamental(good);
    if (!F) break;
    const int count = mark_inliers(pairs, *F, settings.threshold, inlier);
    if (count < best.inliers) break;
    best = {*F, inlier, count};
  }
  return best;
}

double sampson_distance(const Eigen::Matrix3d& F, const PointPair& pair) {
  const Eigen::Vector3d x = pair.first.homogeneous(), y = pair.second.homogeneous();
  const Eigen::Vector3d line = F * x, back = F.transpose() * y;
  const double size = line.head<2>().squaredNorm() + back.head<2>().squaredNorm();
  return size > 0.0 ? std::abs(y.dot(line)) / std::sqrt(size) : 0.0;
}

double epipolar_distance(const Eigen::Matrix3d& F, const PointPair& pair) {
  const Eigen::Vector3d line = F * pair.first.homogeneous();
  const double size = line.head<2>().norm();
  return size > 0.0 ? std::abs(pair.second.homogeneous().dot(line)) / size : 0.0;
}

}  // namespace penumbra::slam
