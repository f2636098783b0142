// The folder that rosbag2 makes: metadata.yaml and one recording split into files, NAME_0.mcap, NAME_1.mcap,
// ... or .db3.
#pragma once

#include <filesystem>
#include <memory>

#include "slam/sources/bag/message_source.h"

namespace penumbra::slam {

// Whether there is a metadata.yaml beside files that end with .mcap or .db3.
bool is_bag_folder(const std::filesystem::path& path);

// All files of the folder, in the order of the numbers in their names, as one recording. Throws InputError
// for a file that was compressed as a whole (.zstd).
std::unique_ptr<MessageSource> open_bag_folder(const std::filesystem::path& path);

}  // namespace penumbra::slam
