// Locates a frame without a prediction, by its likeness to the last one that was located: where no motion is
// known, or it has changed. A search around the last pose would find far points only, and those fit any small
// motion. So descriptors are compared without a window, and P3P finds the pose in RANSAC.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

// A rough pose; nothing where too few pairs agree on one. About 10 ms for 2000 features.
std::optional<SE3> pose_by_descriptors(const LocatingInput& in);

// Looks around the `rough` pose; without one around the predicted pose, where any motion is known. `spare`:
// another hypothesis, for its memory.
void locate_by_descriptors(const LocatingInput& in, const std::optional<SE3>& rough, Hypothesis& found,
                           Hypothesis& spare);

}  // namespace penumbra::slam
