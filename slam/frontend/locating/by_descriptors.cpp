#include "slam/frontend/locating/by_descriptors.h"

#include "slam/frontend/locating/by_motion.h"
#include "slam/geometry/pnp_ransac.h"

namespace penumbra::slam {

std::optional<SE3> pose_by_descriptors(const LocatingInput& in) {
  const StereoCamera& camera = in.map.camera();
  const FeatureView measured(*in.frame.features, in.frame.movable);
  const std::vector<PoseObservation> observations = in.last.match_anywhere(measured);
  PnpRansacSettings ransac;
  ransac.seed = static_cast<std::uint64_t>(in.frame.index);
  ransac.fewest_inliers = in.fewest(in.settings.fewest_frame_inliers);
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera, observations, ransac);
  if (!pnp) return std::nullopt;
  const PoseEstimate dominant = optimize_pose(camera, *pnp, observations);
  return in.world_pose({camera, observations, dominant}).estimate.T_cw;
}

void locate_by_descriptors(const LocatingInput& in, const std::optional<SE3>& rough, Hypothesis& found,
                           Hypothesis& spare) {
  if (rough || in.motion_known) {
    locate_around(in, rough.value_or(in.predicted), rough && !in.prior, found, spare);
  } else {
    found.begin(in.frame, in.reference);
  }
}

}  // namespace penumbra::slam
