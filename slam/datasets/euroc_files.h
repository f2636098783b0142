// The files of a EuRoC recording that are not images.
#pragma once

#include <filesystem>

#include "slam/datasets/rectification.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// sensor.yaml of a camera.
struct EurocCamera {
  LensCamera lens;
  SE3 T_BS;  // body from camera
};
// Throws InputError (file:line) for keys that are missing or numbers that no camera has.
EurocCamera read_euroc_camera(const std::filesystem::path& path);

// state_groundtruth_estimate0/data.csv: T_WB. Throws InputError (file:line).
Trajectory read_euroc_ground_truth(const std::filesystem::path& path);

}  // namespace penumbra::slam
