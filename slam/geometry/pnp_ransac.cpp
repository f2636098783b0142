#include "slam/geometry/pnp_ransac.h"

#include <cmath>

#include "nn/base/counter_random.h"
#include "slam/geometry/p3p.h"

namespace penumbra::slam {

namespace {

int count_inliers(const StereoCamera& camera, std::span<const PoseObservation> observations, const SE3& T_cw,
                  std::vector<char>& inlier) {
  inlier.assign(observations.size(), 0);
  int count = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!within_gate(camera, T_cw * observations[i].point, observations[i].measurement)) continue;
    inlier[i] = 1;
    ++count;
  }
  return count;
}

// Three different indices below n.
std::array<std::size_t, 3> draw_three(std::uint64_t seed, std::uint64_t draw, std::size_t n) {
  std::array<std::size_t, 3> drawn{};
  std::uint64_t counter = draw << 16U;
  for (std::size_t k = 0; k < 3;) {
    drawn[k] = static_cast<std::size_t>(counter_random(seed, counter++) % n);
    bool repeated = false;
    for (std::size_t earlier = 0; earlier < k; ++earlier) repeated = repeated || drawn[earlier] == drawn[k];
    if (!repeated) ++k;
  }
  return drawn;
}

}  // namespace

std::optional<PnpResult> solve_pnp_ransac(const StereoCamera& camera,
                                          std::span<const PoseObservation> observations,
                                          const PnpRansacSettings& settings) {
  const std::size_t n = observations.size();
  if (n < 3 || static_cast<int>(n) < settings.fewest_inliers) return std::nullopt;
  PnpResult best;
  std::vector<char> inlier;
  double needed = settings.most_draws;
  for (int draw = 0; draw < settings.most_draws && draw < needed; ++draw) {
    const auto drawn = draw_three(settings.seed, static_cast<std::uint64_t>(draw), n);
    std::array<Eigen::Vector3d, 3> points, rays;
    for (std::size_t k = 0; k < 3; ++k) {
      const PoseObservation& o = observations[drawn[k]];
      points[k] = o.point;
      rays[k] = camera.back_project(o.measurement.pixel.x(), o.measurement.pixel.y(), 1.0).normalized();
    }
    for (const SE3& T_cw : solve_p3p(points, rays)) {
      const int count = count_inliers(camera, observations, T_cw, inlier);
      if (count <= best.inliers) continue;
      best = {T_cw, inlier, count};
      const double share = static_cast<double>(count) / static_cast<double>(n);
      const double all_good = share * share * share;
      needed = all_good < 1.0 ? std::log(1.0 - settings.confidence) / std::log1p(-all_good) : 1.0;
    }
  }
  if (best.inliers < settings.fewest_inliers) return std::nullopt;
  return best;
}

}  // namespace penumbra::slam
