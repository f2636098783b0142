// Relative pose error: how well the estimate knows the motion over a step from frame i to frame j,
//
//   E_ij = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j)      P_i = T_wc of the estimate, Q_i of the reference
//   translation part: || trans(E_ij) ||  metres        rotation part: angle of rot(E_ij)  degrees
//
// A rigid motion of either world changes nothing; a scale does.
//
// Which pairs (i, j): consecutive steps that do not overlap, chosen as evo does by default:
//   by frames   0, N, 2N, ...
//   by metres   frames are cut wherever the path of the estimate since the last cut has reached M metres; the
//               stretch before the first cut is not used
//
// Source: J. Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012, section IV-A;
// evo's `evo_rpe` without --all_pairs.
#pragma once

#include <utility>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

using FramePairs = std::vector<std::pair<int, int>>;

// Empty where the trajectory is too short. Preconditions: frames >= 1, metres > 0; throws UsageError
// otherwise.
FramePairs pairs_by_frames(const Trajectory& trajectory, int frames);
FramePairs pairs_by_metres(const Trajectory& trajectory, double metres);

struct RelativePoseErrors {
  std::vector<double> translation;  // metres, one per pair
  std::vector<double> rotation;     // degrees
};

// The trajectories are paired index by index; throws InputError where they differ in length.
RelativePoseErrors relative_pose_errors(const Trajectory& reference, const Trajectory& estimate,
                                        const FramePairs& pairs);

}  // namespace penumbra::slam
