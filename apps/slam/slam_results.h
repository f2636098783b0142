// What `penumbra slam` leaves behind: the files of its --out folder, the map, and a few lines on the
// terminal.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/view/slam_report.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

// Where a run's results go.
struct ResultPlaces {
  std::filesystem::path out;       // folder; empty: none is asked for
  std::filesystem::path save_map;  // file; empty: none is asked for
};

// Makes the folder where it is missing, and tries whether both can be written. Throws Error.
void prepare_places(const ResultPlaces& places);

// Writes trajectories, run.json, frames.json and map, then the pictures, so that what was computed is kept
// before what can be drawn again; fills run.evaluation where there is ground truth, and run.dense from
// `dense`, whose map it writes, too (null: none). What cannot be written costs only itself: of a picture a
// warning, of all else an Error that names it once everything else is written.
void write_results(const ResultPlaces& places, const slam::StereoDataset& dataset,
                   const slam::Recorder& record, slam::DenseMapper* dense, SlamRun& run);

// The same, without pictures and ground truth, in the middle of a run, whose worker may go on. Writes the map
// of --save-map beside its place, with the ending .checkpoint, which write_results removes; all else writes
// the function that it returns, on any thread, while the run goes on. That throws as write_results does.
std::function<void()> write_checkpoint(const ResultPlaces& places, const slam::Recorder& record,
                                       const SlamRun& run);

// Where the body stands to the camera, for people.
std::string body_text(const slam::Mounting& body);

// Says which pieces of the map nothing ties to the first: they stand where they were guessed.
void warn_of_pieces(const slam::Recorder& record);

// Logs, and notes in the run, where masks came so late that what moves fast was already elsewhere.
void warn_of_late_masks(const slam::Recorder& record, SlamRun& run);

// `report`: what write_results wrote as run.json.
void print_summary(const nlohmann::json& report, const std::filesystem::path& out);

}  // namespace penumbra::apps
