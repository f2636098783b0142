// Ways of a hand-held camera, as those that the TUM RGB-D benchmark was recorded along.
//
//   still       held still: drifts by about a centimetre
//   xyz         to and fro along the three axes, one after the other, by 0.35 m
//   rpy         turns about the three axes, one after the other, by 25 degrees
//   halfsphere  over a half sphere of 1 m diameter, looking at its target
//   desk        sweeps round the target, 1.3 to 1.7 m away
//   twolaps     two laps round the target on an ellipse; the last pose is the first
//
// Each is a smooth function of time, different for every seed, with the tremor of a hand on top: rotations of
// 0.1 degrees and translations of 1.5 mm at 1 to 7 Hz. Source: Sturm et al., A Benchmark for the Evaluation
// of RGB-D SLAM Systems, IROS 2012 (the paths).
#pragma once

#include <filesystem>
#include <string>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam::synthetic {

struct HandHeldPath {
  std::string kind = "xyz";
  Eigen::Vector3d stand = Eigen::Vector3d(0.0, -1.4, -2.3);   // where the camera is held, world frame, metres
  Eigen::Vector3d target = Eigen::Vector3d(0.0, -0.85, 0.2);  // what it looks at
  Eigen::Vector2d laps = Eigen::Vector2d(3.5, 2.5);           // half axes of `twolaps` along x and z, metres
  double rate = 30.0;                                         // frames a second
  std::uint32_t seed = 1;
};

// Throws UsageError for an unknown kind.
Trajectory hand_held_trajectory(const HandHeldPath& path, int frames);

// The poses of a file in TUM's format, sampled at `rate` from its first pose on, which is moved to `first`;
// cut to `frames` (0 = all). Throws InputError for a bad file.
Trajectory recorded_trajectory(const std::filesystem::path& file, const SE3& first, double rate, int frames);

// A camera at `from` that looks at `to`, its rows level.
SE3 looking_at(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace penumbra::slam::synthetic
