#include "slam/tracking/recognition.h"

#include "slam/features/descriptor_matcher.h"
#include "slam/features/measurement.h"
#include "slam/geometry/pnp_ransac.h"
#include "slam/tracking/pose_optimizer.h"

namespace penumbra::slam {

namespace {

std::optional<Recognition> recognise(const StereoCamera& camera, const Frame& frame, KeyFrame* keyframe,
                                     const std::vector<double>& scales, int fewest_inliers) {
  std::vector<Descriptor> descriptors;
  std::vector<MapPoint*> points;
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    if (keyframe->points[i] == nullptr) continue;
    points.push_back(keyframe->points[i]);
    descriptors.push_back(keyframe->features->descriptor(static_cast<int>(i)));
  }
  std::vector<PoseObservation> observations;
  std::vector<Match> matches;
  for (const Match& match : match_descriptors(descriptors, frame.features->left.descriptors, {})) {
    if (frame.features->is_movable(match.feature)) continue;
    matches.push_back(match);
    observations.push_back({points[static_cast<std::size_t>(match.source)]->position,
                            measurement_of(*frame.features, match.feature, scales)});
  }
  PnpRansacSettings ransac;
  ransac.seed = static_cast<std::uint64_t>(frame.index);
  ransac.fewest_inliers = fewest_inliers;
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera, observations, ransac);
  if (!pnp) return std::nullopt;
  const PoseEstimate estimate = optimize_pose(camera, pnp->T_cw, observations);
  if (estimate.inliers < fewest_inliers) return std::nullopt;

  Recognition found;
  found.keyframe = keyframe;
  found.T_cw = estimate.T_cw;
  found.inliers = estimate.inliers;
  found.points.assign(static_cast<std::size_t>(frame.features->size()), nullptr);
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (!estimate.inlier[m]) continue;
    found.points[static_cast<std::size_t>(matches[m].feature)] =
        points[static_cast<std::size_t>(matches[m].source)];
  }
  return found;
}

}  // namespace

std::optional<Recognition> recognise_frame(const StereoCamera& camera, const Frame& frame, const Map& map,
                                           int newest_keyframes, int fewest_inliers) {
  std::optional<Recognition> best;
  const std::vector<KeyFrame*>& keyframes = map.keyframes();
  const int count = static_cast<int>(keyframes.size());
  for (int n = 0; n < newest_keyframes && n < count; ++n) {
    KeyFrame* keyframe = keyframes[static_cast<std::size_t>(count - 1 - n)];
    std::optional<Recognition> found = recognise(camera, frame, keyframe, map.scales(), fewest_inliers);
    if (found && (!best || found->inliers > best->inliers)) best = std::move(found);
  }
  return best;
}

}  // namespace penumbra::slam
