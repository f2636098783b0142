// Keeps what reports need of every frame of a run.
#pragma once

#include <vector>

#include "slam/brain/brain.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam::brain {

class BrainRecorder {
 public:
  explicit BrainRecorder(const CameraMount& mount = {}) : mount_(mount) {}

  // `map`: as it is after the frame.
  const BrainResult& add(BrainResult result, const CognitiveMap& map, double milliseconds);

  const std::vector<BrainResult>& results() const { return results_; }
  const std::vector<double>& milliseconds() const { return milliseconds_; }
  // T_wc of every frame by what the map says now: the first camera's frame is the world.
  Trajectory trajectory(const CognitiveMap& map) const;
  // The same as the robot believed at the time.
  const Trajectory& believed() const { return believed_; }

  std::vector<int> keyframes() const;  // frames
  std::vector<Recall> recalls() const;

 private:
  TimedPose pose_of(const BrainResult& result, const CognitiveMap& map) const;

  CameraMount mount_;
  std::vector<BrainResult> results_;
  std::vector<double> milliseconds_;
  Trajectory believed_;
};

}  // namespace penumbra::slam::brain
