// Pairs the poses of two trajectories, or the images of two cameras, by time.
//
// Greedy, one to one, as TUM's tool does for colour and depth: of all pairs that are at most `max_difference`
// seconds apart the nearest is taken, then the nearest of what is left. What finds no partner is left out,
// and so is what has the time of the one before it in its list. (evo takes for every pose of the shorter
// trajectory the nearest of the longer one, perhaps twice; with the longer trajectory the denser one, as is
// usual, both give the same pairs.) Cost: O(n log n). Source: associate.py of the TUM RGB-D benchmark (Sturm
// et al. 2012).
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
// Of two lists of times, each in increasing order; the pairs are in the order of the first.
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
