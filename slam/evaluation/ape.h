// Absolute pose error (absolute trajectory error): how far the estimated positions lie from the true ones,
//
//   e_i = || p_i - q_i ||    metres;  p_i position of the estimate (after alignment), q_i of the reference
//
// Source: J. Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012, section IV-B;
// evo's `evo_ape` with pose relation "trans_part" gives the same numbers.
#pragma once

#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// One error per pose, in order. The trajectories are paired index by index (association.h) and already
// aligned (alignment.h); throws InputError where they are empty or differ in length.
std::vector<double> absolute_pose_errors(const Trajectory& reference, const Trajectory& estimate);

}  // namespace penumbra::slam
