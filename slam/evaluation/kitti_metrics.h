// The KITTI odometry benchmark's drift: translation and rotation error over path segments of fixed lengths.
//
// For every tenth frame i and every length L in metres, j is the first frame whose distance along the
// reference path from frame i exceeds L; where the path ends before, the segment is left out. With P = T_wc
// of the estimate and Q of the reference,
//
//   E = (P_i^-1 P_j)^-1 (Q_i^-1 Q_j)
//   t_rel = mean over all segments of || trans(E) || / L  in per cent
//   r_rel = mean over all segments of angle(E) / L        in degrees per 100 m
//
// Source: A. Geiger, P. Lenz, R. Urtasun, Are we ready for Autonomous Driving?, CVPR 2012; odometry
// development kit, evaluate_odometry.cpp. Two differences, both towards exactness: double instead of float,
// and the angle from the quaternion, whose error is that of the matrix entries, where acos((trace - 1) / 2)
// turns an entry's rounding of 1e-7 into 3e-4 rad.
#pragma once

#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// 100, 200, ..., 800 metres.
const std::vector<double>& default_segment_lengths();

// Mean drift over segments; without any segment (count 0) there is no drift to speak of.
struct SegmentDrift {
  double length = 0.0;       // metres; 0 for all lengths together
  int count = 0;             // segments
  double translation = 0.0;  // t_rel, per cent
  double rotation = 0.0;     // r_rel, degrees per 100 m
};

// Length of the path through all positions, metres.
double path_length(const Trajectory& trajectory);

struct KittiMetrics {
  SegmentDrift overall;
  std::vector<SegmentDrift> by_length;  // as many as lengths asked for, in their order
  double path_length = 0.0;             // of the reference, metres
};

// The trajectories are paired index by index; throws InputError where they are empty or differ in length, and
// UsageError for no length or a length <= 0. Cost: O(frames * lengths).
KittiMetrics kitti_metrics(const Trajectory& reference, const Trajectory& estimate,
                           const std::vector<double>& lengths = default_segment_lengths());

}  // namespace penumbra::slam
