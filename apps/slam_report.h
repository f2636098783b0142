// run.json: what a run of `penumbra slam` did, for people and for scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "slam/evaluation/evaluation.h"
#include "slam/slam.h"

namespace penumbra::apps {

struct SlamRun {
  std::string dataset;  // its name
  slam::SlamSettings settings;
  bool segmentation = false;
  bool deterministic = false;
  std::size_t peak_arena_bytes = 0;            // of the network's activations
  std::string error;                           // empty: the run came to its end
  std::optional<slam::Evaluation> evaluation;  // where there is ground truth
};

// Keys: dataset, error, settings, frames, tracked, lost, lost_frames, keyframes, map_points,
// movable_features, peak_arena_bytes (with segmentation), median_ms, p95_ms, stages (medians in ms),
// mismatch_filter (kept, removed), ground_truth (APE, drift) where there is one.
nlohmann::json slam_report(const SlamRun& run, const slam::Slam& slam);

}  // namespace penumbra::apps
