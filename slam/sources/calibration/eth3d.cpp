#include <fmt/core.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

CameraFile read_eth3d(const std::filesystem::path& path) {
  CameraFile file;
  const std::string place = path.string() + ":1";
  set_intrinsics(file.left, nn::parse_numbers(nn::read_text_file(path, "a calibration"), place), place);
  take_for_rgbd(file, place);
  file.depth_factor = 5000.0;
  file.notes = {"ETH3D's calibration.txt: undistorted images, depths of 5000 levels a metre"};
  return file;
}

}  // namespace penumbra::slam
