// Writes a fleet's plan: a folder from which Slurm, or this machine alone, makes one map of many recordings.
// What is scheduled, restarted and ended is Slurm's business; the scripts only say what depends on what.
//
//   jobs.tsv      a line a recording: name, folder where its paths begin, words of its `penumbra slam`
//                 quoted for a shell; with tabs between
//   settings.sh   the program, and options of sbatch; may be edited
//   step.sh       does one of them, merges or reports     (apps/fleet/scripts)
//   submit.sh     hands all that is not done to Slurm
//   here.sh       does the same without Slurm
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/fleet/manifest.h"

namespace penumbra::apps {

struct FleetPlan {
  std::vector<FleetRecording> recordings;
  std::filesystem::path folder;   // of the manifest: where the recordings' paths begin
  std::string program;            // path of penumbra on the nodes
  int processors = 2;             // of a recording
  int memory_mb = 2000;           // of a recording
  int merge_memory_mb = 8000;     // of the merge
  std::string time = "04:00:00";  // of each job at most
  int at_once = 0;                // recordings at the same time at most; 0: as the cluster has place
  // Recordings, one after the other in the manifest, that are merged first where there are more; 0: all at
  // once. Unless it is said: up to 40 at once, of more their square root.
  std::optional<std::size_t> district_size{};
  std::vector<std::string> sbatch{};  // more options of every job
};

// What write_fleet_plan writes.
inline constexpr const char* kFleetPlanFiles[] = {"jobs.tsv", "settings.sh", "step.sh", "submit.sh",
                                                  "here.sh"};

// Makes the folder where it is missing and replaces an earlier plan; results stay, and count as long as the
// recording's line is the same. Throws Error where the folder cannot be written.
void write_fleet_plan(const std::filesystem::path& folder, const FleetPlan& plan);

}  // namespace penumbra::apps
