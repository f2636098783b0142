// What `penumbra slam` leaves behind: the files of its --out folder, and a few lines on the terminal.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/slam_report.h"
#include "slam/datasets/stereo_dataset.h"
#include "slam/slam.h"

namespace penumbra::apps {

// Writes trajectories, map, picture, gallery, frames.json and run.json into the folder `out`; fills
// run.evaluation where there is ground truth.
void write_results(const std::filesystem::path& out, const slam::StereoDataset& dataset,
                   const slam::Slam& slam, SlamRun& run);

// Says which pieces of the map nothing ties to the first: they stand where they were guessed.
void warn_of_pieces(const slam::Slam& slam);

// `report`: what write_results wrote as run.json.
void print_summary(const nlohmann::json& report, const std::filesystem::path& out);

}  // namespace penumbra::apps
