// A run's trajectory against the truth that its recording has.
#pragma once

#include <optional>

#include "slam/evaluation/evaluation.h"
#include "slam/geometry/association.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

// Ground truth and estimate of the frames that have both, the ground truth moved so that it starts where the
// estimate starts. Empty where the recording has none.
slam::TrajectoryPair pair_with_ground_truth(const slam::StereoDataset& dataset,
                                            const slam::Trajectory& estimate);

// Empty for fewer than two pairs.
std::optional<slam::Evaluation> evaluate_run(const slam::TrajectoryPair& pair);

}  // namespace penumbra::apps
