// sensor.yaml, which EuRoC and TUM-VI have beside the images of each camera.
#pragma once

#include <filesystem>

#include "slam/geometry/rectification.h"

namespace penumbra::slam {

struct EurocCamera {
  LensCamera lens;
  SE3 T_BS;  // body from camera
};
// Throws InputError (file:line) for keys that are missing or numbers that no camera has.
EurocCamera read_euroc_camera(const std::filesystem::path& path);

}  // namespace penumbra::slam
