#include "penumbra/evaluation.h"

#include "apps/library/poses.h"
#include "slam/evaluation/evaluation.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra {

namespace {

slam::Trajectory trajectory_of(const std::vector<TimedPose>& poses, const char* place) {
  slam::Trajectory trajectory;
  for (const TimedPose& pose : poses)
    trajectory.push_back({pose.timestamp, motion_of(pose.T_world_camera, place)});
  return trajectory;
}

}  // namespace

PathError evaluate(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate) {
  const slam::TrajectoryPair pair = slam::associate_by_time(
      trajectory_of(truth, "a pose of the truth"), trajectory_of(estimate, "a pose of the estimate"));
  const slam::ErrorStatistics ape = slam::evaluate_trajectory(pair.reference, pair.estimate).ape;
  return {static_cast<int>(pair.estimate.size()), ape.rmse, ape.mean, ape.median, ape.max};
}

std::vector<TimedPose> read_trajectory(const std::string& path) {
  std::vector<TimedPose> poses;
  for (const slam::TimedPose& pose : slam::read_tum_trajectory(path))
    poses.push_back({pose.timestamp, pose_of(pose.T_wc)});
  return poses;
}

}  // namespace penumbra
