// Pairs the poses of two trajectories by time.
//
// For every pose of the shorter trajectory the nearest in time of the longer one is taken, if they are at
// most `max_difference` seconds apart (as evo does). Each pose is used at most once: where two poses choose
// the same partner, the closer one keeps it (evo would use the partner twice; with the longer trajectory the
// denser one, as is usual, both give the same pairs). Poses without a partner are left out. Cost: O(n log n).
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

inline constexpr double kMaxTimeDifference = 0.01;  // seconds

// Places in two lists of times.
using TimePair = std::pair<std::size_t, std::size_t>;
// The same for any two lists of times, each in increasing order; in the order of time.
std::vector<TimePair> associate_times(std::span<const double> first, std::span<const double> second,
                                      double max_difference);

// Two trajectories of equal length whose i-th poses belong together; each keeps its own timestamps.
struct TrajectoryPair {
  Trajectory reference, estimate;
};

// Both must be ordered by time. Throws InputError where no pose finds a partner; where the clocks differ, it
// says by how much.
TrajectoryPair associate_by_time(const Trajectory& reference, const Trajectory& estimate,
                                 double max_difference = kMaxTimeDifference);

}  // namespace penumbra::slam
