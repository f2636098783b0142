// A fleet's manifest: which recordings become one map. A line a recording, words as in a shell, without
// variables and patterns; '#' begins a comment.
//
//   # name        recording           calibration   options of `penumbra slam`
//   monday        bags/monday.bag     -
//   tuesday-1     "new bags/1.mcap"   rig.yaml      --frames 0:3000 --filter off
//   kitti-06      kitti               -             --sequence 06
//
// Paths, also those in options, are relative to the manifest's folder; "-": the recording has its calibration
// with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace penumbra::apps {

struct FleetRecording {
  std::string name;                    // of the folder of its results: letters, digits, '.', '_', '-'
  std::vector<std::string> arguments;  // of `penumbra slam`, without where results go
};

// Throws InputError naming the line where a word is missing or its quotes do not end, a name cannot be a
// folder's or stands twice, a recording, a calibration or a file that an option names (--weights, --masks)
// does not exist, options are none of `penumbra slam` or say what the plan says (--out, --save-map,
// --load-map); where there is no recording at all.
std::vector<FleetRecording> read_fleet_manifest(const std::filesystem::path& path);

}  // namespace penumbra::apps
