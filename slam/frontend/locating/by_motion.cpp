#include "slam/frontend/locating/by_motion.h"

#include <utility>

#include "slam/frontend/locating/last_frame_search.h"
#include "slam/frontend/locating/local_map_search.h"

namespace penumbra::slam {

void locate_by_motion(const LocatingInput& in, Hypothesis& found, Hypothesis& spare) {
  locate_around(in, in.predicted, /*may_leave_map=*/in.prior.has_value(), found, spare);
}

void locate_around(const LocatingInput& in, const SE3& start, bool may_leave_map, Hypothesis& found,
                   Hypothesis& spare) {
  const TrackerSettings& settings = in.settings;
  search_last_frame(in, start, settings.search_radius, in.prior, found);
  if (!in.is_clear(found.pairs(), in.last_pairs)) {
    search_last_frame(in, start, settings.wide_search_radius, in.prior, spare);
    if (spare.pairs() > found.pairs()) std::swap(found, spare);
  }
  if (found.success) continue_in_map(in, in.prior, may_leave_map, found, spare);
}

void continue_in_map(const LocatingInput& in, const std::optional<PosePrior>& prior, bool may_leave_map,
                     Hypothesis& found, Hypothesis& spare) {
  may_leave_map =
      may_leave_map && in.settings.extends_map && found.pairs() >= in.fewest(in.settings.fewest_step_inliers);
  if (may_leave_map) spare = found;
  search_local_map(in, prior, found);
  if (found.success || !may_leave_map) return;
  std::swap(found, spare);
  found.inliers = found.pairs();
  found.off_map = true;
}

}  // namespace penumbra::slam
