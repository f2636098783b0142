// What the report's page draws, as JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "slam/map/ply.h"

namespace penumbra::apps {

constexpr std::size_t kMostPagePoints = 60000;    // of a map, that a page shows
constexpr std::size_t kMostDensePoints = 200000;  // of a dense map

// A folder that `penumbra slam` wrote: run.json, frames.json, trajectory_kitti.txt, map.ply, and where they
// are there ground_truth_tum.txt, dense.ply and gallery/. Keys: run and frames (those files), estimate and
// truth (positions, metres), error (metres, frame by frame), lost (rows), loops (pairs of rows), points,
// dense, gallery (JPEGs, base64). Throws InputError for a folder that holds no run, or a damaged one.
nlohmann::json report_data(const std::filesystem::path& run_folder, std::size_t most_points);

// At most `most` of the points, evenly taken: position (three little-endian floats each) and colour (three
// bytes each), both in base64.
nlohmann::json points_json(const std::vector<slam::PlyVertex>& vertices, std::size_t most);

}  // namespace penumbra::apps
