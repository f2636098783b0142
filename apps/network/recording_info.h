// What `penumbra info` says of recordings of robots.
#pragma once

#include <filesystem>

namespace penumbra::apps {

// Lists the topics of a bag or MCAP file, and which of them `penumbra slam` would take. Throws InputError
// where it cannot be read.
void show_recording(const std::filesystem::path& path, bool json);

}  // namespace penumbra::apps
