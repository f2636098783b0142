#include "slam/brain/position/gridness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nn/base/quantile.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kIsGridCell = 0.3;
constexpr std::size_t kNarrowest = 4;  // bins, of a best ring

// Sums of the bins nearer than i, for every i; two discs and their products.
struct DiscSums {
  std::vector<double> a, b, ab, aa, bb;
};

double ring_correlation(const DiscSums& sums, const std::vector<std::size_t>& within, std::size_t inner,
                        std::size_t outer) {
  const auto of = [&](const std::vector<double>& disc) { return disc[outer] - disc[inner]; };
  const double n = std::max(1.0, static_cast<double>(within[outer] - within[inner]));
  const double a = of(sums.a), b = of(sums.b);
  const double variances = std::max(n * of(sums.aa) - a * a, 1e-9) * std::max(n * of(sums.bb) - b * b, 1e-9);
  return (n * of(sums.ab) - a * b) / std::sqrt(variances);
}

// Where the peak at the centre ends: the ring's mean falls below 0.1 or begins to rise.
std::size_t end_of_centre(const std::vector<double>& sums, const std::vector<std::size_t>& within) {
  const auto mean = [&](std::size_t ring) {
    return (sums[ring + 1] - sums[ring]) /
           std::max(1.0, static_cast<double>(within[ring + 1] - within[ring]));
  };
  for (std::size_t ring = 1; ring + 7 < within.size(); ++ring) {
    if (mean(ring) < 0.1 || mean(ring + 1) > mean(ring)) return ring;
  }
  return 3;
}

}  // namespace

Gridness::Gridness(int radius) : radius_(radius - 1) {
  struct Bin {
    int x, y, squared;
  };
  std::vector<Bin> disc;
  for (int y = -radius_; y <= radius_; ++y) {
    for (int x = -radius_; x <= radius_; ++x) {
      if (x * x + y * y <= radius_ * radius_) disc.push_back({x, y, x * x + y * y});
    }
  }
  std::stable_sort(disc.begin(), disc.end(),
                   [](const Bin& a, const Bin& b) { return a.squared < b.squared; });
  for (int i = 0; i <= radius_; ++i) {
    within_.push_back(static_cast<std::size_t>(
        std::partition_point(disc.begin(), disc.end(), [&](const Bin& bin) { return bin.squared < i * i; }) -
        disc.begin()));
  }
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = turn * std::numbers::pi / 6.0, c = std::cos(angle), s = std::sin(angle);
    for (const Bin& bin : disc) {
      const double x = c * bin.x - s * bin.y, y = s * bin.x + c * bin.y;
      const int left = static_cast<int>(std::floor(x)), low = static_cast<int>(std::floor(y));
      turned_[static_cast<std::size_t>(turn)].push_back(
          {left, low, static_cast<float>(x - left), static_cast<float>(y - low)});
    }
  }
}

GridnessScores Gridness::score(const Autocorrelogram& map, double spacing) const {
  const auto sample = [&](const Turned& bin) {
    const auto at = [&](int dx, int dy) {
      return map.at(std::clamp(dx, -map.radius, map.radius), std::clamp(dy, -map.radius, map.radius));
    };
    const float low = at(bin.dx, bin.dy) * (1.0F - bin.right) + at(bin.dx + 1, bin.dy) * bin.right;
    const float high = at(bin.dx, bin.dy + 1) * (1.0F - bin.right) + at(bin.dx + 1, bin.dy + 1) * bin.right;
    return static_cast<double>(low * (1.0F - bin.up) + high * bin.up);
  };
  std::vector<double> straight;
  for (const Turned& bin : turned_[0]) straight.push_back(sample(bin));
  if (straight.front() == 0.0) return {};  // nothing changes: no correlation even with itself
  std::array<DiscSums, kTurns> sums;
  for (std::size_t turn = 1; turn < kTurns; ++turn) {
    DiscSums& disc = sums[turn];
    double a = 0, b = 0, ab = 0, aa = 0, bb = 0;
    std::size_t next = 0;
    for (const std::size_t count : within_) {
      for (; next < count; ++next) {
        const double x = straight[next], y = sample(turned_[turn][next]);
        a += x, b += y, ab += x * y, aa += x * x, bb += y * y;
      }
      disc.a.push_back(a), disc.b.push_back(b), disc.ab.push_back(ab);
      disc.aa.push_back(aa), disc.bb.push_back(bb);
    }
  }
  const auto on_ring = [&](std::size_t inner, std::size_t outer) {
    const auto c = [&](std::size_t turn) { return ring_correlation(sums[turn], within_, inner, outer); };
    return std::min(c(2), c(4)) - std::max({c(1), c(3), c(5)});
  };
  const auto largest = static_cast<std::size_t>(radius_);
  GridnessScores scores;
  scores.fixed = on_ring(static_cast<std::size_t>(std::lround(0.5 * spacing)),
                         std::min(largest, static_cast<std::size_t>(std::lround(1.4 * spacing))));
  const std::size_t inner = end_of_centre(sums[1].a, within_);
  scores.best = -2.0;
  for (std::size_t outer = inner + kNarrowest; outer <= largest; ++outer) {
    scores.best = std::max(scores.best, on_ring(inner, outer));
  }
  return scores;
}

GridnessSummary summary_of(std::span<const double> scores) {
  GridnessSummary summary;
  if (scores.empty()) return summary;
  summary.median = quantile_of({scores.begin(), scores.end()}, 0.5);
  summary.share = static_cast<double>(std::count_if(scores.begin(), scores.end(),
                                                    [](double score) { return score > kIsGridCell; })) /
                  static_cast<double>(scores.size());
  return summary;
}

}  // namespace penumbra::slam::brain
