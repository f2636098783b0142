// A picture of a trajectory seen from above, against the ground truth where there is one: equal scale on both
// axes, a grid in metres, start and end marked.
#pragma once

#include <string>

#include "slam/evaluation/plot_canvas.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// Which plane is looked at; "right" and "up" are directions on the picture.
enum class PlotPlane {
  xz,  // x right, z up: worlds whose y points down, as KITTI's (the first camera's frame)
  xy   // x right, y up: worlds whose z points up, as TUM's and EuRoC's
};

struct TrajectoryPlotOptions {
  std::string title = "Trajectory";
  std::string subtitle;  // under the title; empty: number of poses and path length
  std::string estimate_name = "estimate";
  PlotPlane plane = PlotPlane::xz;
};

// A plot of 1000 to 1500 pixels a side. `ground_truth` may be empty; it must already be in the
// estimate's world (alignment.h). Throws Error where `estimate` is empty or a position is not finite.
PlotCanvas draw_trajectories(const Trajectory& estimate, const Trajectory& ground_truth,
                             const TrajectoryPlotOptions& options = {});

}  // namespace penumbra::slam
