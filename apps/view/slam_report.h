// run.json: what a run of `penumbra slam` did, for people and for scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slam/evaluation/evaluation.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/pipeline/recorder.h"

namespace penumbra::apps {

struct SlamRun {
  std::string dataset;                 // its name
  std::optional<slam::Mounting> body;  // of --body
  std::string segmentation = "off";    // which frames, as on the command line
  bool finished = false;               // false: a checkpoint, the map's worker is still at it
  std::size_t peak_arena_bytes = 0;    // of the network's activations
  double cpu_seconds = 0.0;            // of all threads, from the first frame to the finished map
  StageTimer input_times;              // of the thread that reads the images
  StageTimer dense_times;              // of depth from pairs of images, for the dense map
  double peak_rss_mb = 0.0;            // of the process
  std::vector<int> unreadable_frames;
  std::vector<std::string> warnings;           // what is probably wrong (slam/pipeline/run_check.h)
  std::string why_lost;                        // empty where all frames were located
  double median_depth = 0.0;                   // metres, of the features
  nlohmann::json stream;                       // of a stream: frames, dropped, delays; else null
  nlohmann::json dense;                        // what dense_report says; null: none was made
  std::string error;                           // empty: the run came to its end
  std::optional<slam::Evaluation> evaluation;  // where there is ground truth
};

// Keys: dataset, command (to repeat the run), version, unfinished (at a checkpoint), error, warnings,
// why_lost, body (with --body: frame, body_from_camera: rows of [R t] that take points of the left camera to
// it; ground_truth is then compared with its poses), stream (frames, dropped, mean_delay_s and
// longest_delay_s until a frame was taken, longest_silence_s from one to the next, ended_by where a signal
// did, remark of the cameras), settings, frames, tracked, lost, lost_frames, unreadable_frames, path_m,
// mean_speed_mps (of the frames that were located), median_depth_m (of the features), keyframes (of this
// run), loaded_keyframes (of the map that it began with), map_points, uncertain_points (of these, that are
// left out of map.ply), movable_features, occluded_frames, instances (objects and their states), masks_late_s
// (from a frame that was segmented to the first that knew of it: median, most), peak_arena_bytes (with
// segmentation), median_ms, p95_ms, cpu_ms_per_frame (of all threads), processor_ms (the same by thread and
// stage, see processor_times.h), peak_rss_mb, stages (medians in ms), mismatch_filter (kept, removed),
// ground_truth (APE, drift; of the located frames) where there is one, loops (pairs of frames, the later
// first), loop_closures (every correction of the map, with what is known of it), recognised_places (frame,
// earlier frame, points, and objects where the points alone had not been enough), submaps (pieces of the map
// that are not tied to each other, see slam/pipeline/slam.h), keyframe_frames, covisibility (frame, earlier
// frame, points that both keyframes see), dense (see dense_report; where one was made). The thread that calls
// Slam::process() may ask, also before finish().
nlohmann::json slam_report(const SlamRun& run, const slam::Recorder& record);

// Of a dense map: voxels, voxel_m, classes (names, their numbers are their places), views, megabytes, floor
// (whether one was found), depth_to_m (how far depth counts), cell_m (of the plan), floor_from_m (where the
// floor comes into the images; with a floor), plan_cells (free, blocked, unknown), plan_from_map (rows of [R
// t]: from the map's world, in which trajectories and clouds are, to the plan's).
nlohmann::json dense_report(const slam::DenseMap& map, const slam::DenseSettings& settings);

// What is doubtful about it: no floor, or a plan of a strip, with how far depth counted and what lets it
// count farther. Empty: nothing.
std::string plan_doubt(const slam::DenseMap& map, const slam::DenseSettings& settings, slam::Sensor sensor);

// The loops in which this run came to a place of its own again: pairs of frames, the later first.
nlohmann::json revisits_json(const std::vector<slam::ClosedLoop>& loops,
                             const slam::LoopCloserSettings& settings);

// The report as text: an entry a line, objects over several.
std::string to_text(const nlohmann::json& report);

}  // namespace penumbra::apps
