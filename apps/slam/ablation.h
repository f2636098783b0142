// The ablation of the semantics: one synthetic drive, run with one combination of what the SLAM can use.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/instance.h"

namespace penumbra::apps {

// What leaves features out, from nothing to the upper bound.
enum class MaskSource {
  none,      // every feature is taken for the world's; nothing looks for movers
  movers,    // no masks, large rigid movers found by geometry alone
  classes,   // the network's masks; whatever can move is left out, as DynaSLAM does
  geometry,  // the network's masks; what geometry finds moving is left out
  truth,     // exact masks, geometry decides what moves
};

MaskSource parse_mask_source(const std::string& name);  // UsageError for another name
std::string name_of(MaskSource source);

struct AblationCell {
  std::string preset;
  int seed = 1, frames = 0;
  Size size;  // of the images
  MaskSource masks = MaskSource::none;
  std::string weights;  // name of the network; empty where masks come from none
  std::string filter = "adaptive";

  std::string drive_name() const;
  std::string name() const;  // of its file
};

// Renders the cell's drive below `folder` unless it is there, whole, already.
std::filesystem::path render_drive(const AblationCell& cell, const std::filesystem::path& folder);

// Keys: ate_m, rpe_m, angle_deg, loops, loop_precision, loop_recall (of the keyframes, see
// slam/evaluation/loop_evaluation.h), tracked, lost, occluded, median_ms. Runs deterministically; segments
// keyframes.
nlohmann::json run_cell(const AblationCell& cell, const std::filesystem::path& drive,
                        const slam::Segmenter& segmenter);

// Rows of the table: cells that differ by nothing but their seed, mean and standard deviation of each figure.
// `cells`: objects with the cell's keys and run_cell's.
nlohmann::json summarise_cells(const nlohmann::json& cells);
std::string format_table(const nlohmann::json& rows);

}  // namespace penumbra::apps
