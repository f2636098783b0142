#include "slam/dynamics/rgbd/foreground_depths.h"

#include <algorithm>
#include <cmath>

#include "slam/dynamics/rgbd/line_dbscan.h"

namespace penumbra::slam {

namespace {

// Share of the ascending `depths` that lies in `range`.
double share_within(const DepthRange& range, std::span<const float> depths) {
  if (depths.empty()) return 0.0;
  const auto first = std::lower_bound(depths.begin(), depths.end(), range.nearest);
  const auto end = std::upper_bound(first, depths.end(), range.farthest);
  return static_cast<double>(end - first) / static_cast<double>(depths.size());
}

}  // namespace

std::optional<DepthRange> ForegroundDepths::find(std::vector<float>& in_box, std::vector<float>& in_ring) {
  if (static_cast<int>(in_box.size()) < std::max(2, settings_.fewest)) return std::nullopt;
  std::sort(in_box.begin(), in_box.end());
  std::sort(in_ring.begin(), in_ring.end());
  return settings_.mode == ForegroundMode::paper ? find_as_paper(in_box) : find_adaptive(in_box, in_ring);
}

std::optional<DepthRange> ForegroundDepths::find_as_paper(std::span<const float> in_box) {
  const int n = static_cast<int>(in_box.size());
  const int fewest = std::clamp(static_cast<int>(std::lround(std::log(n))), 1, n - 1);
  nearest_distances(in_box, fewest, distance_);
  std::sort(distance_.begin(), distance_.end());
  if (line_dbscan(in_box, knee_of(distance_), fewest, cluster_) == 0) return std::nullopt;
  // Clusters of a line come in the order of their means.
  const auto first = std::find(cluster_.begin(), cluster_.end(), 0);
  const auto end = std::find_if(first, cluster_.end(), [](int c) { return c > 0; });
  const auto last = std::find(std::reverse_iterator(end), cluster_.rend(), 0);
  return DepthRange{in_box[static_cast<std::size_t>(first - cluster_.begin())],
                    in_box[static_cast<std::size_t>(last.base() - cluster_.begin() - 1)]};
}

std::optional<DepthRange> ForegroundDepths::find_adaptive(std::span<const float> in_box,
                                                          std::span<const float> in_ring) {
  logs_.resize(in_box.size());
  std::transform(in_box.begin(), in_box.end(), logs_.begin(), [](float z) { return std::log(z); });
  const int fewest = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(in_box.size()))));
  const int clusters = line_dbscan(logs_, static_cast<float>(settings_.eps), fewest, cluster_);
  std::optional<DepthRange> best;
  double most = 0.0;
  std::size_t i = 0;
  for (int c = 0; c < clusters; ++c) {
    while (cluster_[i] != c) ++i;
    DepthRange range{in_box[i], in_box[i]};
    for (; i < in_box.size() && (cluster_[i] == c || cluster_[i] == kNoise); ++i)
      if (cluster_[i] == c) range.farthest = in_box[i];
    const double score = share_within(range, in_box) - share_within(range, in_ring);
    if (score <= most) continue;
    most = score;
    best = range;
  }
  return best;
}

}  // namespace penumbra::slam
