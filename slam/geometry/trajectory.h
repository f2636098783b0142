// A trajectory: time-stamped camera poses in the world, ordered by time.
#pragma once

#include <vector>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct TimedPose {
  double timestamp = 0.0;  // seconds
  SE3 T_wc;                // world from camera
};

using Trajectory = std::vector<TimedPose>;

}  // namespace penumbra::slam
