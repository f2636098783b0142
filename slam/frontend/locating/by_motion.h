// Locates a frame where the motion so far leads to: first against the last frame that was located, then
// against the map. What nearly every frame is located by.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

// Looks around the predicted pose. `spare`: another hypothesis, for its memory.
void locate_by_motion(const LocatingInput& in, Hypothesis& found, Hypothesis& spare);

// The pose around `start` with which most pairs of the last frame agree, first in a narrow window, then in a
// wide one; then the map's. Where the map has too few points here, as after a fast turn, what the last frame
// tells is enough if it tells it clearly and the frame `may_leave_map`: a keyframe then makes the points.
// (Far points alone fit any motion, so only a start that RANSAC has found may.)
void locate_around(const LocatingInput& in, const SE3& start, bool may_leave_map, Hypothesis& found,
                   Hypothesis& spare);

// The second half of it: from the pose that the last frame tells to the map's, or off the map.
void continue_in_map(const LocatingInput& in, const std::optional<PosePrior>& prior, bool may_leave_map,
                     Hypothesis& found, Hypothesis& spare);

}  // namespace penumbra::slam
