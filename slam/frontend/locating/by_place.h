// Locates a frame in the whole map, without a prediction: by what it looks like (slam/place/recognition.h),
// then against the map there. For frames that are lost, and the first one in a map that was loaded.
#pragma once

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/locating_input.h"

namespace penumbra::slam {

void locate_by_place(const LocatingInput& in, Hypothesis& found);

}  // namespace penumbra::slam
