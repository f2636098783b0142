#include "slam/dynamics/rgbd/line_dbscan.h"

#include <algorithm>

namespace penumbra::slam {

int line_dbscan(std::span<const float> x, float eps, int fewest, std::vector<int>& cluster) {
  const std::size_t n = x.size();
  cluster.assign(n, kNoise);
  int last_cluster = -1;
  std::size_t low = 0, high = 0, last_core = n;  // n: none yet
  for (std::size_t i = 0; i < n; ++i) {
    while (x[i] - x[low] > eps) ++low;
    while (high < n && x[high] - x[i] <= eps) ++high;
    const bool reached = last_core < n && x[i] - x[last_core] <= eps;
    if (high - low < static_cast<std::size_t>(fewest)) {
      if (reached) cluster[i] = last_cluster;
      continue;
    }
    if (!reached) ++last_cluster;
    cluster[i] = last_cluster;
    for (std::size_t j = i; j-- > low && cluster[j] == kNoise;) cluster[j] = last_cluster;
    last_core = i;
  }
  return last_cluster + 1;
}

void nearest_distances(std::span<const float> x, int k, std::vector<float>& distance) {
  const std::size_t n = x.size(), steps = static_cast<std::size_t>(k);
  distance.resize(n);
  std::size_t first = 0;  // of the k + 1 numbers around i, i among them
  for (std::size_t i = 0; i < n; ++i) {
    while (first + steps < i ||
           (first < i && first + steps + 1 < n && x[first + steps + 1] - x[i] < x[i] - x[first]))
      ++first;
    distance[i] = std::max(x[i] - x[first], x[std::min(first + steps, n - 1)] - x[i]);
  }
}

float knee_of(std::span<const float> curve) {
  if (curve.empty()) return 0.0F;
  const float width = static_cast<float>(curve.size()), height = curve.back() - curve.front();
  std::size_t knee = curve.size() - 1;
  float deepest = 0.0F;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const float below = static_cast<float>(i) * height - (curve[i] - curve.front()) * (width - 1.0F);
    if (below <= deepest) continue;
    deepest = below;
    knee = i;
  }
  return curve[knee];
}

}  // namespace penumbra::slam
