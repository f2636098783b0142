// Pictures of a run of the brain-inspired SLAM.
#pragma once

#include "slam/brain/brain_recorder.h"
#include "slam/evaluation/plot_canvas.h"
#include "slam/geometry/association.h"

namespace penumbra::apps {

// The cognitive map from above: nodes, the ways between them, and links by which places were recalled.
slam::PlotCanvas draw_cognitive_map(const slam::brain::CognitiveMap& map);

// Distance from the true position over time (the paper's figure 9): as the robot believed at the time, and by
// the settled map; each moment in which a place was recalled is marked. `believed` and `settled` are paired
// with the truth, aligned at their start. Throws Error where they are empty.
slam::PlotCanvas draw_error_over_time(const slam::TrajectoryPair& believed,
                                      const slam::TrajectoryPair& settled,
                                      const std::vector<double>& recall_times);

// Activity of the place cells over time (8), from the grid cells' activity at the keyframe and at the cell:
// a column a keyframe, a row a node, darker where it is more active; at most 400 of each.
ByteImage draw_place_activity(const slam::brain::CognitiveMap& map, const slam::brain::BrainRecorder& record);

}  // namespace penumbra::apps
