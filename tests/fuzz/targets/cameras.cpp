// Readers of what comes with a camera's images: calibrations in YAML, and lists of images.
#include <cmath>

#include "slam/sources/calibration/calibration.h"
#include "slam/sources/calibration/sensor_yaml.h"
#include "slam/sources/calibration/yaml_file.h"
#include "slam/sources/image_list.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

namespace {

void require_lens(const slam::LensCamera& lens) {
  require(std::isfinite(lens.fx) && lens.fx > 0.0 && std::isfinite(lens.fy) && lens.fy > 0.0,
          "focal lengths are positive");
  require(std::isfinite(lens.cx) && std::isfinite(lens.cy), "the principal point is finite");
  require(lens.width >= 0 && lens.height >= 0, "sizes are not negative");
  require(lens.distortion.size() <= 8, "lenses have few coefficients");
}

void require_motion(const slam::SE3& T) {
  require(T.is_finite() && std::abs(T.rotation.determinant() - 1.0) < 0.01, "motions are rigid");
}

}  // namespace

// As calibration.yaml and as EuRoC's sensor.yaml.
bool read_camera_file(std::string_view bytes) {
  const MemoryFile file(bytes);
  is_read([&] { slam::YamlFile yaml(file.path()); });
  const bool is_sensor = is_read([&] {
    const slam::EurocCamera camera = slam::read_euroc_camera(file.path());
    require_lens(camera.lens);
    require(camera.lens.width > 0, "EuRoC gives the size");
    require_motion(camera.T_BS);
  });
  return is_read([&] {
           const slam::CameraFile camera = slam::read_camera_file(file.path());
           require_lens(camera.left);
           if (!camera.rectified) {
             require_lens(camera.right);
             require_motion(camera.T_right_left);
           } else {
             require(std::isfinite(camera.baseline) && camera.baseline > 0.0, "the baseline is positive");
           }
           require(camera.depth_factor > 0.0, "the depth factor is positive");
         }) ||
         is_sensor;
}

bool read_image_list(std::string_view bytes) {
  const MemoryFile file(bytes);
  bool is_list = false;
  for (const auto read : {slam::read_tum_image_list, slam::read_euroc_image_list}) {
    is_list |= is_read([&] {
      const std::vector<slam::ListedImage> images = read(file.path()).images;
      require(!images.empty(), "a list has images");
      for (std::size_t i = 0; i < images.size(); ++i) {
        require(std::isfinite(images[i].timestamp), "times are finite");
        require(i == 0 || images[i].timestamp > images[i - 1].timestamp, "times grow");
        require(!images[i].name.empty() && images[i].name.front() != '/', "names lie in the folder");
      }
    });
  }
  return is_list;
}

}  // namespace penumbra::fuzz
