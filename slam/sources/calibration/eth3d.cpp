#include "nn/base/number_file.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

CameraFile read_eth3d(const std::filesystem::path& path) {
  CameraFile file;
  const std::string place = path.string() + ":1";
  nn::LineReader reader(path, "ETH3D's calibration, fx fy cx cy");
  set_intrinsics(file.left, nn::parse_numbers(reader.next().value_or(""), place), place);
  take_for_rgbd(file, place);
  file.depth_factor = 5000.0;
  file.notes = {"ETH3D's calibration.txt: undistorted images, depths of 5000 levels a metre"};
  return file;
}

}  // namespace penumbra::slam
