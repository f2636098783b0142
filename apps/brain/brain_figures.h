// What a run of the brain-inspired SLAM is worth, against the true path.
#pragma once

#include <nlohmann/json.hpp>

#include "slam/brain/brain_recorder.h"
#include "slam/evaluation/loop_evaluation.h"
#include "slam/pipeline/recorder.h"

namespace penumbra::apps {

// Rows of the truth, the later first: the keyframes that knew a place again, and its node's frame.

std::vector<slam::FramePair> recalled_pairs(const slam::brain::BrainRecorder& record);

// How far the views alone get: the most similar template of each keyframe, by its similarity.
struct SimilarityCurve {
  // Share of the revisits among the keyframes whose most similar template is of the same place, at the lowest
  // threshold at which every keyframe above it is right; and that threshold.
  double recall_at_full_precision = 0.0, threshold = 1.0;
  // The same without a threshold.
  double recall = 0.0;
};
SimilarityCurve similarity_curve(const slam::Trajectory& truth, const slam::brain::BrainRecorder& record,
                                 const slam::brain::CognitiveMap& map,
                                 const slam::RevisitSettings& settings = {});

// Keys of both: ate_m (root mean square after a rigid alignment), rpe_percent and rpe_deg_per_100m (KITTI's,
// over 100 to 800 m or what the path has), recalls, precision, recall (of the keyframes that are revisits),
// keyframes, map_mb, ms (mean a frame), ms_first, ms_last (mean of the first and last 500 frames or tenth).
// `truth`: a pose a frame, in the order of the frames, whose numbers begin with 0.

// Also curve (see above), missed (frames of revisits that were not recalled), blurred, nodes, links.
nlohmann::json brain_figures(const slam::Trajectory& truth, const slam::brain::Brain& brain,
                             const slam::brain::BrainRecorder& record);
// Of a run of the geometric SLAM: a recall is a keyframe that was proven to show an earlier place; nodes are
// its keyframes, map_mb is without the images.
nlohmann::json geometric_figures(const slam::Trajectory& truth, const slam::Recorder& record,
                                 const std::vector<double>& milliseconds);

}  // namespace penumbra::apps
