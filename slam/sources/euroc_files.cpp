#include "slam/sources/euroc_files.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "nn/base/error.h"
#include "nn/image/image_container.h"
#include "slam/sources/camera_file.h"
#include "slam/sources/known_keys.h"
#include "slam/sources/lens_reader.h"
#include "slam/sources/yaml_file.h"

namespace penumbra::slam {

namespace fs = std::filesystem;

namespace {

// Of these the first six are used.
const std::vector<KnownKey>& sensor_keys() {
  static const std::vector<KnownKey> keys = {
      {"T_BS", {}},
      {"resolution", {"image_size"}},
      {"camera_model", {}},
      {"intrinsics", {}},
      {"distortion_model", {}},
      {"distortion_coefficients", {"distortion_coeffs", "distortion"}},
      {"sensor_type", {}},
      {"comment", {"name", "description"}},
      {"rate_hz", {"rate"}},
      {"rostopic", {}},
  };
  return keys;
}

}  // namespace

EurocCamera read_euroc_camera(const fs::path& path) {
  YamlFile yaml(path);
  use_known_keys(yaml, sensor_keys());
  require_pinhole(yaml, "camera_model");
  EurocCamera camera;
  const std::vector<double> size = yaml.numbers("resolution", 2);
  for (const double pixels : size) {
    if (!(pixels >= 1.0 && pixels <= 65535.0 && pixels == std::floor(pixels))) {
      throw InputError(yaml.place("resolution"), "width and height in pixels", fmt::format("{:g}", pixels));
    }
  }
  if (size[0] * size[1] > static_cast<double>(nn::kMaxImagePixels)) {
    throw InputError(yaml.place("resolution"), "an image that can be",
                     fmt::format("{:g} x {:g}", size[0], size[1]));
  }
  camera.lens.width = static_cast<int>(size[0]);
  camera.lens.height = static_cast<int>(size[1]);
  const std::vector<double> K = yaml.numbers("intrinsics", 4);
  camera.lens.fx = K[0];
  camera.lens.fy = K[1];
  camera.lens.cx = K[2];
  camera.lens.cy = K[3];
  if (!(K[0] > 0.0 && K[1] > 0.0)) {
    throw InputError(yaml.place("intrinsics"), "focal lengths > 0", fmt::format("{:g} and {:g}", K[0], K[1]));
  }
  set_lens_model(camera.lens, yaml.text("distortion_model"), yaml.numbers("distortion_coefficients"),
                 yaml.place("distortion_coefficients"));
  camera.T_BS = read_transform(yaml, "T_BS");
  return camera;
}

}  // namespace penumbra::slam
