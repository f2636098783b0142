// Compares a frame with the last one that was located, around a pose that it may have.
//
//   project the last frame's points -> match -> mismatch filter -> pose -> leave out what moves as one
//
// About 2 ms for 2000 features.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

// The pose around `start` with which the most pairs agree, looked for `radius` pixels (of level 0) around
// where the last frame's points project. `prior` counts as one more observation.
void search_last_frame(const LocatingInput& in, const SE3& start, float radius,
                       const std::optional<PosePrior>& prior, Hypothesis& found);

}  // namespace penumbra::slam
