#include "slam/frontend/locating/local_map_search.h"

#include "slam/frontend/locating/local_map.h"
#include "slam/frontend/locating/map_matching.h"

namespace penumbra::slam {

void search_local_map(const LocatingInput& in, const std::optional<PosePrior>& prior, Hypothesis& found) {
  const auto scope = in.timer.measure("local_map");
  const StereoCamera& camera = in.map.camera();
  const std::vector<double>& scales = in.map.scales();
  thread_local LocalMapCollector collector;  // for its memory
  const LocalMap& local = collector.collect(found.points, found.reference, in.settings.local_keyframes);
  found.reference = local.reference;
  match_map_points(camera, scales, local.points, in.settings.map_search_radius, in.frame, found);
  const std::vector<PoseObservation> observations = refine_observations(camera, scales, in.frame, found);
  const PoseEstimate estimate = optimize_pose(camera, found.T_cw, observations, prior);
  found.inliers = keep_agreeing(camera, scales, observations, estimate, in.frame, found);
  found.success = found.inliers >= in.fewest(in.settings.fewest_map_inliers);
  if (found.success) {
    found.T_cw = estimate.T_cw;
    found.information = estimate.information;
  } else {
    found.inliers = 0;
  }
}

}  // namespace penumbra::slam
