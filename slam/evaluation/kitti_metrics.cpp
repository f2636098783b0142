#include "slam/evaluation/kitti_metrics.h"

#include <algorithm>
#include <numbers>

#include "nn/base/error.h"
#include "slam/evaluation/alignment.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kFirstFrameStep = 10;

// Distance along the path from frame 0 to each frame, metres.
std::vector<double> path_distances(const Trajectory& trajectory) {
  std::vector<double> distances = {0.0};
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    distances.push_back(distances.back() +
                        (trajectory[i].T_wc.translation - trajectory[i - 1].T_wc.translation).norm());
  }
  return distances;
}

}  // namespace

const std::vector<double>& default_segment_lengths() {
  static const std::vector<double> lengths = {100, 200, 300, 400, 500, 600, 700, 800};
  return lengths;
}

double path_length(const Trajectory& trajectory) { return path_distances(trajectory).back(); }

KittiMetrics kitti_metrics(const Trajectory& reference, const Trajectory& estimate,
                           const std::vector<double>& lengths) {
  require_paired(reference, estimate, 1);
  if (lengths.empty()) throw UsageError("segment lengths: expected at least one, in metres");
  const std::vector<double> distances = path_distances(reference);
  KittiMetrics metrics;
  metrics.path_length = distances.back();
  for (const double length : lengths) {
    if (!(length > 0.0)) throw UsageError(fmt::format("segment length {:g} m: expected more than 0", length));
    SegmentDrift drift;
    drift.length = length;
    for (std::size_t i = 0; i < reference.size(); i += kFirstFrameStep) {
      const auto end = std::upper_bound(distances.begin(), distances.end(), distances[i] + length);
      if (end == distances.end()) break;
      const auto j = static_cast<std::size_t>(end - distances.begin());
      const SE3 error = (estimate[i].T_wc.inverse() * estimate[j].T_wc).inverse() *
                        (reference[i].T_wc.inverse() * reference[j].T_wc);
      drift.translation += error.translation.norm() / length * 100.0;
      drift.rotation += error.angle() * 180.0 / std::numbers::pi / length * 100.0;
      ++drift.count;
    }
    metrics.overall.count += drift.count;
    metrics.overall.translation += drift.translation;
    metrics.overall.rotation += drift.rotation;
    if (drift.count > 0) {
      drift.translation /= drift.count;
      drift.rotation /= drift.count;
    }
    metrics.by_length.push_back(drift);
  }
  if (metrics.overall.count > 0) {
    metrics.overall.translation /= metrics.overall.count;
    metrics.overall.rotation /= metrics.overall.count;
  }
  return metrics;
}

}  // namespace penumbra::slam
