// One self-contained HTML page about a run of `penumbra slam`.
#pragma once

#include <filesystem>
#include <string>

namespace penumbra::apps {

// The page for a folder that `penumbra slam` wrote: run.json, frames.json, trajectory_kitti.txt, map.ply, and
// where they are there ground_truth_tum.txt and gallery/. Everything is inside the page, three.js included:
// it opens without a network. Of the map at most `most_points` points are taken. Throws InputError for
// a folder that holds no run, or a damaged one.
std::string make_report_page(const std::filesystem::path& run_folder, std::size_t most_points = 60000);

}  // namespace penumbra::apps
