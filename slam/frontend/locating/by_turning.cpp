#include "slam/frontend/locating/by_turning.h"

#include <utility>

#include "slam/frontend/locating/by_motion.h"
#include "slam/frontend/locating/last_frame_search.h"

namespace penumbra::slam {

void locate_by_turning(const LocatingInput& in, const SE3& start, Hypothesis& found, Hypothesis& spare) {
  constexpr int kTurns = 5;                                                  // to each side
  const double turn = 1.5 * in.settings.search_radius / in.map.camera().fx;  // radians
  std::optional<PosePrior> prior = in.prior;
  SE3 best;
  found.begin(in.frame, in.reference);
  for (int k = -kTurns; k <= kTurns; ++k) {
    Vector6d motion = Vector6d::Zero();
    motion[4] = k * turn;
    prior->T_cw = SE3::exp(motion) * start;
    search_last_frame(in, prior->T_cw, in.settings.search_radius, prior, spare);
    if (spare.pairs() <= found.pairs()) continue;
    std::swap(found, spare);
    best = prior->T_cw;
  }
  if (!found.success) return;
  prior->T_cw = best;
  continue_in_map(in, prior, /*may_leave_map=*/true, found, spare);
}

}  // namespace penumbra::slam
