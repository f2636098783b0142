// Reads the two trajectories that `penumbra eval` compares and finds the poses that belong together.
#pragma once

#include <string>

#include "slam/evaluation/alignment.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::apps {

struct PairingOptions {
  std::string ground_truth, estimate;  // files
  std::string format = "auto";         // of both; auto: each by its columns
  std::string frames;                  // "A:B", lines of the ground truth; formats without times only
  double max_time_difference = slam::kMaxTimeDifference;
  double time_offset = 0.0;  // seconds, added to the estimate's times
};

struct PairedTrajectories {
  slam::TrajectoryPair pair;
  slam::TrajectoryFormat format;      // of the ground truth
  std::size_t in_truth, in_estimate;  // poses in the files, or in the part of it
};

// Formats with times are paired by them; those without by their lines or frame numbers. Warns of what the
// readers did. Throws InputError where nothing pairs, UsageError where the formats or options do not fit
// together.
PairedTrajectories pair_trajectories(const PairingOptions& options);

// Throws InputError where there are fewer than three pairs to fit an alignment to; warns where there are
// fewer than ten, or than half of the shorter trajectory.
void check_pair_count(const PairedTrajectories& paired, slam::Alignment alignment);

}  // namespace penumbra::apps
