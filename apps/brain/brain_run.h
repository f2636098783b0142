// A run of `penumbra brain`: opens the recording, finds its self-motion, feeds the brain frame by frame, and
// keeps what it finds whatever happens.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/common/dataset_arguments.h"
#include "slam/brain/brain_settings.h"

namespace penumbra::apps {

struct BrainOptions {
  DatasetArguments dataset;
  std::filesystem::path weights;
  std::string out, odometry, noise, save_map, load_map;
  std::string templates = "landmarks", relaxation = "settled", interest = "on", sight = "on";
  std::optional<double> camera_yaw, camera_pitch;  // degrees; with noise: by default what the true path says
  double least_sharpness = slam::brain::BrainSettings{}.least_sharpness;
  int seed = 1;
};

// Throws UsageError for options that do not fit together; InputError and Error for what cannot be read or
// written, and where the run was stopped. All results that there are are written before.
void run_brain(const BrainOptions& options);

}  // namespace penumbra::apps
