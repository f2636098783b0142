// Bundle adjustment of a whole map: all keyframes and points of one sub-map (slam/map/keyframe.h).
//
// The oldest keyframe is fixed. Two passes as in the local one: with the Huber kernel, then without it and
// without the observations beyond their chi-square gate; those that are beyond it at the end leave the map.
// Points with a single observation say nothing about poses and move along with their keyframe.
//
// The second pass adjusts the stereo camera's disparity offset, too, where the sub-map is most of the map,
// and apply() gives it to the map. One below 0.05 pixels is taken for none: so much may come from how
// disparities are measured.
//
// The numbers are copied out of the map, adjusted, and copied back, so that a thread may adjust while the map
// grows: solve() touches no map. Keyframes that were added meanwhile move along (newcomers.h).
// What is stopped half-way can be applied, for no iteration makes the errors larger; but no observation
// leaves the map for it, since what does not fit yet may fit in the end. Cost: linear in
// the observations, and the factor of the poses (block_cholesky.h): 0.2 s an iteration for 900 keyframes
// along a street that is driven three times.
#pragma once

#include <atomic>
#include <vector>

#include "slam/backend/bundle_adjustment.h"
#include "slam/map/map.h"

namespace penumbra::slam {

struct FullBundleSettings {
  int robust_iterations = 10;  // at most, with the Huber kernel
  int iterations = 10;         // at most, without
  int threads = 1;
  // Pixels, as BundleProblem's; 0 for an RGB-D camera, whose right columns follow from its depth.
  double disparity_offset_sigma = 0.2;
};

struct FullBundleReport {
  int keyframes = 0, points = 0, observations = 0, removed_observations = 0;
  LeastSquaresSummary robust, final;
  bool stopped = false;  // before its end
};

class FullBundleAdjustment {
 public:
  // Copies the part of the map that belongs to `submap`.
  FullBundleAdjustment(const Map& map, int submap, const FullBundleSettings& settings);

  // Ends after the iteration in which `stop` is set.
  void solve(const std::atomic<bool>* stop = nullptr);
  void apply(Map& map);
  const FullBundleReport& report() const { return report_; }

 private:
  FullBundleSettings settings_;
  BundleProblem problem_;
  std::vector<KeyFrame*> keyframes_;  // of the problem's poses
  std::vector<MapPoint*> points_;     // of the problem's points
  FullBundleReport report_;
};

}  // namespace penumbra::slam
