// Everything that Penumbra says about an estimated trajectory, in one call: align, then APE, RPE and KITTI
// drift of the aligned estimate. (A rigid alignment changes APE only; a similarity also rescales the motion
// that RPE and drift look at.)
#pragma once

#include <vector>

#include "slam/evaluation/alignment.h"
#include "slam/evaluation/kitti_metrics.h"
#include "slam/evaluation/statistics.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

struct EvaluationOptions {
  Alignment alignment = Alignment::se3;
  int rpe_frames = 1;         // step of the RPE by frames
  double rpe_metres = 100.0;  // step of the RPE by metres
  std::vector<double> segment_lengths = default_segment_lengths();
};

struct Evaluation {
  int poses = 0;
  Similarity alignment;  // what was applied to the estimate
  Trajectory aligned_estimate;
  ErrorStatistics ape;                              // metres
  ErrorStatistics rpe_frames, rpe_frames_rotation;  // metres, degrees per step
  ErrorStatistics rpe_metres, rpe_metres_rotation;  // count 0: the path is shorter than two steps
  KittiMetrics kitti;
};

// The trajectories are paired index by index; throws InputError where they are empty or differ in length, and
// UsageError for steps and lengths that are not positive.
Evaluation evaluate_trajectory(const Trajectory& reference, const Trajectory& estimate,
                               const EvaluationOptions& options = {});

}  // namespace penumbra::slam
