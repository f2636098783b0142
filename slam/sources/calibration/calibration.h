// A camera's calibration, whoever wrote it: our own calibration.yaml or one of the dialects of dialects.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/sources/calibration/camera_file.h"

namespace penumbra::slam {

struct Calibration {
  std::string dialect;  // "Kalibr's camchain"; "Penumbra" for our own
  CameraFile camera;
};

// Of one file, or of two that each describe one camera, the left one first. Throws InputError (file:line)
// where it cannot be read; files of tools whose dialect is not read are named.
Calibration read_calibration(const std::vector<std::filesystem::path>& files);

// The same of one file.
CameraFile read_camera_file(const std::filesystem::path& path);

// As text in our own keys, which reads back as the same camera.
std::string calibration_text(const CameraFile& camera);

}  // namespace penumbra::slam
