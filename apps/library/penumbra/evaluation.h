// How far an estimated path is from the true one.
#pragma once

#include <string>
#include <vector>

#include "penumbra/export.h"
#include "penumbra/pose.h"

namespace penumbra {

// Of the positions, after the rigid motion that brings the two together best (Sturm et al. 2012); the numbers
// of `penumbra eval` and of evo's evo_ape --align.
struct PathError {
  int poses = 0;                                           // that were compared
  double rmse = 0.0, mean = 0.0, median = 0.0, max = 0.0;  // metres
};

// Both ordered by time; poses belong together whose times differ by 10 ms at most. Throws std::runtime_error
// where there are none.
PENUMBRA_API PathError evaluate(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate);

// A file as TUM's benchmark has them: "seconds x y z qx qy qz qw" a line.
PENUMBRA_API std::vector<TimedPose> read_trajectory(const std::string& path);

}  // namespace penumbra
