// An Evaluation as text for people and as JSON for machines.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "slam/evaluation/evaluation.h"

namespace penumbra::apps {

// Tables of APE, RPE and KITTI drift; what the path is too short for is said in words.
std::string evaluation_table(const slam::Evaluation& evaluation, const slam::EvaluationOptions& options);

// {"poses", "path_length_m", "alignment": {"mode", "is_unique", "scale", "rotation", "translation"},
//  "ape_m", "rpe_frames": {"frames", "translation_m", "rotation_deg"},
//  "rpe_metres": {"metres", "translation_m", "rotation_deg"},
//  "kitti": {"segments", "t_rel_percent", "r_rel_deg_per_100m", "by_length": [...]}}
// Statistics are {"count", "rmse", "mean", "median", "std", "min", "max", "sse"}. What the path is too short
// for is null.
nlohmann::ordered_json evaluation_json(const slam::Evaluation& evaluation,
                                       const slam::EvaluationOptions& options);

}  // namespace penumbra::apps
