// A file with settings of the pipeline: JSON, with comments.
//
//   { "tracker": { "search_radius": 12, "mismatch_filter": { "mode": "compensated" } } }
//
// Every setting has its place in the tree (setting_fields.h); what the file does not name stays as it is.
// `penumbra slam --print-settings` prints them all, each with its unit, as such a file.
#pragma once

#include <filesystem>
#include <string>

#include "slam/pipeline/slam.h"

namespace penumbra::slam {

// Throws InputError (file, name of the setting) for text that is not JSON, names that no setting has (with
// the nearest that one has), a name twice, values of another type and out of bounds.
void read_settings(const std::filesystem::path& path, SlamSettings& settings);

// As read_settings reads them.
std::string settings_text(const SlamSettings& settings);

}  // namespace penumbra::slam
