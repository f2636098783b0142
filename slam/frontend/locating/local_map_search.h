// Compares a frame with the part of the map around it: more points, at more exact pixels, for a better pose.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

// Goes on from the pose and the points of `found`: looks for the points of the local map (local_map.h) where
// they project (map_matching.h). Where too few agree, `found` is no success. `prior` counts as one more
// observation. About 4 ms for 2000 features.
void search_local_map(const LocatingInput& in, const std::optional<PosePrior>& prior, Hypothesis& found);

}  // namespace penumbra::slam
