// What `penumbra brain` leaves behind: trajectories, the cognitive map, pictures and run.json.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/result_writer.h"
#include "slam/brain/brain_recorder.h"
#include "slam/geometry/association.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

struct BrainRun {
  std::string dataset, motion;  // names, for people: the recording, where its self-motion is from
  std::vector<std::string> warnings;
  std::string error;  // empty: the run came to its end
  double cpu_seconds = 0.0, peak_rss_mb = 0.0;
  int loaded_nodes = 0;  // of the map that it began with
  int lost = 0;          // frames in which visual odometry was lost
};

// Nodes and links as JSON: nodes {frame, time, x, y, heading, strength, landmarks}, links {from, to, x, y,
// heading, recalled}.
nlohmann::json cognitive_map_json(const slam::brain::CognitiveMap& map,
                                  const slam::brain::TemplateMemory& memory);

// A run's paths, paired with the truth that its recording has.
struct BrainPaths {
  slam::Trajectory settled;  // by the settled map
  // Empty where there is no truth; at_the_time also where what was believed before the way into a loaded map
  // was found is of another world.
  slam::TrajectoryPair by_the_map, at_the_time;
};
BrainPaths paths_of(const slam::StereoDataset& dataset, const slam::brain::Brain& brain,
                    const slam::brain::BrainRecorder& record);

// Writes the pictures trajectory.svg (by the settled map), believed.svg (as believed at the time), both
// against the truth, cognitive_map.svg (nodes, links, recalls), error.svg (distance from the truth over time,
// where there is one, with the recalls marked) and places.png (the place cells' activity over time).
void draw_brain_run(ResultWriter& writer, const std::filesystem::path& out, const std::string& title,
                    const BrainPaths& paths, const slam::brain::CognitiveMap& map,
                    const slam::brain::BrainRecorder& record);

// Writes trajectory_kitti.txt, trajectory_tum.txt, cognitive_map.json, the map for another run where
// `save_map` names a file, frames.json (per frame index, timestamp, ms, keyframe, anchor and recalled, both
// nodes), ground_truth_tum.txt, run.json, then the pictures. Returns run.json. What cannot be written costs
// only itself: of a picture a warning, of all else an Error once everything else is written.
nlohmann::json write_brain_results(const std::filesystem::path& out, const slam::StereoDataset& dataset,
                                   const slam::brain::Brain& brain, const slam::brain::BrainRecorder& record,
                                   const BrainRun& run, const std::filesystem::path& save_map);

}  // namespace penumbra::apps
