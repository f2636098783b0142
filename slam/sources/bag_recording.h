// Recordings of robots in one file: ROS 1 bags, MCAP, rosbag2 (slam/sources/bag/message_source.h).
//
// Read twice: forward, once, for where the images lie, their times and the cameras; then frame by frame.
// Times are those of the headers, in whose order frames are; record times count only for messages without. A
// frame is an image and its partner nearest in time: 1 ms for two cameras, 20 ms for depth, unless options
// say otherwise.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "slam/sources/bag/message_source.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file or topic and what is wrong with it, also where no two topics belong
// together; the message then lists the image topics.
std::unique_ptr<StereoDataset> open_bag_recording(const std::filesystem::path& path,
                                                  const DatasetOptions& options);

// What is in a recording, for `penumbra info`.
struct BagSummary {
  std::string kind;
  std::vector<Topic> topics;        // in the order of their names
  std::vector<std::string> notes;   // of the file
  std::string taken;                // the topics that open_bag_recording would take; empty: none
  std::vector<std::string> frames;  // in which the left camera stands still
  std::string reason;               // why none, where it is known
};
BagSummary summarise_bag(const std::filesystem::path& path);

}  // namespace penumbra::slam
