// Locates a frame behind something large, where a bend may begin or end unseen: the few points that are left
// are looked for as far to the left and right as a turn takes them.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

// Tries turns to both sides of `start`, each as a prior of its own; there must be one. The most pairs win.
// `spare`: another hypothesis, for its memory.
void locate_by_turning(const LocatingInput& in, const SE3& start, Hypothesis& found, Hypothesis& spare);

}  // namespace penumbra::slam
