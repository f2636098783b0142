// Finds known points in a keyframe that does not observe them yet.
#pragma once

#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"

namespace penumbra::slam {

// Projects `points` (nullptr and erased ones are skipped) with the keyframe's pose and looks for each within
// `radius` pixels at level 0. A feature that looks alike and agrees within its chi-square gate becomes an
// observation of the point; where it shows another point already, the two are merged into the one that more
// keyframes observe, or, with `keep_given`, into the given one. Returns how many points were found.
int fuse_points(Map& map, KeyFrame* keyframe, const std::vector<MapPoint*>& points, float radius,
                bool keep_given = false);

}  // namespace penumbra::slam
