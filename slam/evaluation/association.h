// Pairs the poses of two trajectories by time.
//
// For every pose of the shorter trajectory the nearest in time of the longer one is taken, if they are at
// most `max_difference` seconds apart (as evo does). Each pose is used at most once: where two poses choose
// the same partner, the closer one keeps it (evo would use the partner twice; with the longer trajectory the
// denser one, as is usual, both give the same pairs). Poses without a partner are left out. Cost: O(n log n).
#pragma once

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

inline constexpr double kMaxTimeDifference = 0.01;  // seconds

// Two trajectories of equal length whose i-th poses belong together; each keeps its own timestamps.
struct TrajectoryPair {
  Trajectory reference, estimate;
};

// Both must be ordered by time. Throws InputError where no pose finds a partner.
TrajectoryPair associate_by_time(const Trajectory& reference, const Trajectory& estimate,
                                 double max_difference = kMaxTimeDifference);

}  // namespace penumbra::slam
