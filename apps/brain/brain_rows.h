// The rows of `penumbra bench brain`: one recording, gone through once with every way to find the way.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "slam/brain/brain.h"
#include "slam/brain/motion/odometry_noise.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

struct BrainRow {
  std::string name;  // see brain_row_names()
  slam::brain::BrainSettings settings;
  bool geometric = false;  // the SLAM of slam/pipeline instead, which takes the images alone
};

// odometry (no place is recalled), ratslam, no-interest (every landmark counts the same), no-sharpness (no
// keyframe is too blurred), ours, slam.
std::vector<std::string> brain_row_names();
// One of them, or intensity-geometry: ours with RatSLAM's templates. Throws UsageError for another name.
BrainRow brain_row(const std::string& name);

// Per row its figures (brain_figures.h), `name` and `stages` (of each stage mean_ms and times). `finder` may
// be empty where no row has landmarks. `title`: of the progress. `pictures`: where each row but slam gets a
// folder with those of draw_brain_run (brain_results.h); empty: none. Throws InputError where a frame has no
// true pose.
std::vector<nlohmann::json> run_brain_rows(const slam::StereoDataset& dataset,
                                           const std::vector<BrainRow>& rows,
                                           const slam::brain::OdometryNoise& noise, std::uint64_t seed,
                                           const slam::brain::LandmarkFinder& finder,
                                           const std::string& title, const std::filesystem::path& pictures);

}  // namespace penumbra::apps
