// Keyframes that came into the map while an adjustment was computed.
//
// They were no part of it, and the keyframes that they were located against have moved: each keeps its place
// relative to the closest of its older neighbours whose way is known (to the keyframe before it where it is
// tied to none), and the points that only newcomers see keep theirs relative to the oldest of these.
#pragma once

#include <unordered_map>

#include "slam/map/map.h"

namespace penumbra::slam {

// Where keyframes were before the adjustment was applied.
using PosesBefore = std::unordered_map<const KeyFrame*, SE3>;

// Moves the keyframes with ids beyond `newest`, that of the newest keyframe the adjustment knew. A newcomer
// for which none is in `before` stays where it is. `before` learns of those that are moved.
void move_newcomers(Map& map, int newest, PosesBefore& before);

}  // namespace penumbra::slam
