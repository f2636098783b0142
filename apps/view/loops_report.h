// What `penumbra eval-loops` found, as JSON for scripts and as a table for people. A share of nothing is
// null, or "nothing to find": it is neither 0 nor 100 %.
#pragma once

#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "slam/evaluation/loop_evaluation.h"
#include "slam/evaluation/place_index_evaluation.h"

namespace penumbra::apps {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  // of a radian

// `frames`: the number of each frame of the run, by its row.
nlohmann::ordered_json loops_json(const slam::LoopEvaluation& e, const std::vector<int>& frames);
nlohmann::ordered_json recognition_json(const slam::RecognitionEvaluation& e);
nlohmann::ordered_json index_json(const slam::PlaceIndexEvaluation& e);

// The same on standard output.
void print_loops(const slam::LoopEvaluation& e, const std::vector<int>& frames);
void print_recognition(const slam::RecognitionEvaluation& e);
void print_index(const slam::PlaceIndexEvaluation& e);

}  // namespace penumbra::apps
