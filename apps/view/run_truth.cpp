#include "apps/view/run_truth.h"

namespace penumbra::apps {

slam::TrajectoryPair pair_with_ground_truth(const slam::StereoDataset& dataset,
                                            const slam::Trajectory& estimate) {
  slam::TrajectoryPair pair;
  if (!dataset.ground_truth()) return pair;
  std::size_t at = 0;
  for (const slam::TimedPose& pose : *dataset.ground_truth()) {  // with the frames' own times
    while (at < estimate.size() && estimate[at].timestamp < pose.timestamp) ++at;
    if (at == estimate.size()) break;
    if (estimate[at].timestamp != pose.timestamp) continue;
    pair.reference.push_back(pose);
    pair.estimate.push_back(estimate[at]);
  }
  if (pair.reference.empty()) return pair;
  const slam::SE3 moved = pair.estimate.front().T_wc * pair.reference.front().T_wc.inverse();
  for (slam::TimedPose& pose : pair.reference) pose.T_wc = moved * pose.T_wc;
  return pair;
}

std::optional<slam::Evaluation> evaluate_run(const slam::TrajectoryPair& pair) {
  if (pair.reference.size() < 2) return std::nullopt;
  slam::EvaluationOptions options;
  // Short pieces have no segment of a hundred metres.
  if (slam::path_length(pair.reference) < 200.0) options.segment_lengths = {10.0, 20.0, 30.0, 40.0, 50.0};
  return slam::evaluate_trajectory(pair.reference, pair.estimate, options);
}

}  // namespace penumbra::apps
