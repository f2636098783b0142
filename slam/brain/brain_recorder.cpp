#include "slam/brain/brain_recorder.h"

namespace penumbra::slam::brain {

TimedPose BrainRecorder::pose_of(const BrainResult& result, const CognitiveMap& map) const {
  return {result.timestamp,
          mount_.to_camera(camera_pose(map.node(result.anchor).pose * result.since_anchor))};
}

const BrainResult& BrainRecorder::add(BrainResult result, const CognitiveMap& map, double milliseconds) {
  milliseconds_.push_back(milliseconds);
  believed_.push_back(pose_of(result, map));
  return results_.emplace_back(std::move(result));
}

Trajectory BrainRecorder::trajectory(const CognitiveMap& map) const {
  Trajectory trajectory;
  trajectory.reserve(results_.size());
  for (const BrainResult& result : results_) trajectory.push_back(pose_of(result, map));
  return trajectory;
}

std::vector<int> BrainRecorder::keyframes() const {
  std::vector<int> frames;
  for (const BrainResult& result : results_) {
    if (result.keyframe) frames.push_back(result.frame);
  }
  return frames;
}

std::vector<Recall> BrainRecorder::recalls() const {
  std::vector<Recall> recalls;
  for (const BrainResult& result : results_) {
    if (result.confirmed) recalls.push_back(*result.confirmed);
    if (result.recall) recalls.push_back(*result.recall);
  }
  return recalls;
}

}  // namespace penumbra::slam::brain
