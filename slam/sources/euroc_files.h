// The files of a EuRoC recording that are not images.
#pragma once

#include <filesystem>

#include "slam/geometry/rectification.h"

namespace penumbra::slam {

// sensor.yaml of a camera.
struct EurocCamera {
  LensCamera lens;
  SE3 T_BS;  // body from camera
};
// Throws InputError (file:line) for keys that are missing or numbers that no camera has.
EurocCamera read_euroc_camera(const std::filesystem::path& path);

}  // namespace penumbra::slam
