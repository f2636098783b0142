// The JSON files that a run leaves: run.json, frames.json.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace penumbra::apps {

// Throws InputError where there is no such file, or where it is no JSON object.
nlohmann::json read_run_json(const std::filesystem::path& path);

}  // namespace penumbra::apps
