// Trajectories for tests of geometry and evaluation.
#pragma once

#include <cmath>
#include <random>

#include "slam/geometry/trajectory.h"

namespace penumbra::test {

// A winding drive with turns about all axes: about one metre and 0.1 s a frame.
inline slam::Trajectory winding_trajectory(int frames) {
  slam::Trajectory trajectory;
  slam::SE3 pose;
  for (int i = 0; i < frames; ++i) {
    trajectory.push_back({0.1 * i, pose});
    slam::Vector6d step;
    step << 0.0, 0.1 * std::sin(0.05 * i), 1.0, 0.01 * std::sin(0.3 * i), 0.05 * std::sin(0.07 * i), 0.01;
    pose = pose * slam::SE3::exp(step);
  }
  return trajectory;
}

// The same with every pose disturbed by about `metres` and `radians`.
inline slam::Trajectory disturbed(const slam::Trajectory& trajectory, double metres, double radians,
                                  int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  slam::Trajectory result = trajectory;
  for (slam::TimedPose& pose : result) {
    slam::Vector6d noise;
    for (int i = 0; i < 6; ++i) noise[i] = (i < 3 ? metres : radians) * normal(random);
    pose.T_wc = pose.T_wc * slam::SE3::exp(noise);
  }
  return result;
}

// Poses that look along +z, with the given positions.
inline slam::Trajectory path_through(const std::vector<Eigen::Vector3d>& positions) {
  slam::Trajectory trajectory;
  for (const Eigen::Vector3d& position : positions) {
    trajectory.push_back({static_cast<double>(trajectory.size()), {Eigen::Matrix3d::Identity(), position}});
  }
  return trajectory;
}

}  // namespace penumbra::test
