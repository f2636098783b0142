#include "slam/frontend/features/frame_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

namespace {

constexpr int kRotationBins = 30;

// The best feature for one projection; -1 where none passes.
int search(const Projection& p, const FeatureView& frame, std::span<const char> taken, float radius,
           const FrameMatcherSettings& settings, int& best_distance) {
  NearestDescriptor nearest;
  frame.measured().grid.visit_near(p.u, p.v, radius, [&](int i, int level) {
    if (level < p.level - settings.levels_below || level > p.level + settings.levels_above) return;
    if ((!taken.empty() && taken[std::size_t(i)]) || frame.is_movable(i)) return;
    const float u_right = frame.u_right(i);
    if (p.u_right >= 0.0F && u_right >= 0.0F && std::abs(p.u_right - u_right) > radius) return;
    nearest.offer(i, hamming_distance(*p.descriptor, frame.descriptor(i)));
  });
  best_distance = nearest.distance;
  if (nearest.distance > settings.max_distance) return -1;
  const bool same_level =
      nearest.second_index >= 0 && frame.level(nearest.index) == frame.level(nearest.second_index);
  return same_level && nearest.is_ambiguous(settings.ratio) ? -1 : nearest.index;
}

// Removes the pairs whose turn differs from the common one.
void keep_common_rotation(std::span<const float> turns, std::vector<Match>& matches) {
  std::array<int, kRotationBins> count{};
  std::vector<int> bins(matches.size());
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const float turn = turns[m] / (2.0F * std::numbers::pi_v<float>);  // -1..1
    bins[m] = static_cast<int>(std::lround((turn - std::floor(turn)) * kRotationBins)) % kRotationBins;
    ++count[std::size_t(bins[m])];
  }
  std::array<int, kRotationBins> order{};
  for (int b = 0; b < kRotationBins; ++b) order[std::size_t(b)] = b;
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return count[std::size_t(a)] > count[std::size_t(b)]; });
  std::array<bool, kRotationBins> keep{};
  for (std::size_t k = 0; k < 3; ++k) {
    keep[std::size_t(order[k])] = 10 * count[std::size_t(order[k])] >= count[std::size_t(order[0])];
  }
  std::size_t kept = 0;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (keep[std::size_t(bins[m])]) matches[kept++] = matches[m];
  }
  matches.resize(kept);
}

}  // namespace

std::vector<Match> match_projections(std::span<const Projection> projections, const FeatureView& frame,
                                     std::span<const char> taken, std::span<const double> scales,
                                     const FrameMatcherSettings& settings) {
  std::vector<int> owner(static_cast<std::size_t>(frame.size()), -1);  // feature -> index of its match
  std::vector<Match> candidates;
  std::vector<float> turns;
  candidates.reserve(projections.size());
  turns.reserve(projections.size());
  for (const Projection& p : projections) {
    const float radius = settings.radius * static_cast<float>(scales[std::size_t(p.level)]);
    int distance = 0;
    const int feature = search(p, frame, taken, radius, settings, distance);
    if (feature < 0) continue;
    const float turn = p.angle - frame.measured().keypoint(feature).angle;
    int& holder = owner[std::size_t(feature)];
    if (holder < 0) {
      holder = static_cast<int>(candidates.size());
      candidates.push_back({p.source, feature, distance});
      turns.push_back(turn);
    } else if (distance < candidates[std::size_t(holder)].distance) {
      candidates[std::size_t(holder)] = {p.source, feature, distance};
      turns[std::size_t(holder)] = turn;
    }
  }
  if (settings.check_rotation) keep_common_rotation(turns, candidates);
  return candidates;
}

}  // namespace penumbra::slam
