#include "slam/sources/calibration/sensor_yaml.h"

#include <vector>

#include "nn/base/error.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/known_keys.h"
#include "slam/sources/calibration/lens_reader.h"
#include "slam/sources/calibration/yaml_file.h"

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

bool is_sensor_yaml(const YamlFile& yaml) { return yaml.has("T_BS") || yaml.has("T_BS.data"); }

// One is half of a pair.
CameraFile read_alone(const YamlFile& yaml) {
  throw InputError(yaml.place("T_BS"), "the sensor.yaml of both cameras, the left one first", "one file");
}

}  // namespace

EurocCamera read_euroc_camera(const fs::path& path) {
  YamlFile yaml(path);
  use_known_keys(yaml, sensor_keys());
  require_pinhole(yaml, "camera_model");
  EurocCamera camera;
  const std::vector<double> size = yaml.numbers("resolution", 2);
  set_size(camera.lens, size[0], size[1], yaml.place("resolution"));
  set_intrinsics(camera.lens, yaml.numbers("intrinsics", 4), yaml.place("intrinsics"));
  set_lens_model(camera.lens, yaml.text("distortion_model"), yaml.numbers("distortion_coefficients"),
                 yaml.place("distortion_coefficients"));
  camera.T_BS = read_transform(yaml, "T_BS");
  return camera;
}

CameraFile read_sensor_yaml_pair(const fs::path& left, const fs::path& right) {
  const EurocCamera first = read_euroc_camera(left), second = read_euroc_camera(right);
  CameraFile file;
  file.rectified = false;
  file.left = first.lens;
  file.right = second.lens;
  file.T_right_left = second.T_BS.inverse() * first.T_BS;
  file.mountings.push_back({"body", first.T_BS});
  file.place = right.string();
  return file;
}

const CalibrationDialect kSensorYaml = {"a sensor.yaml of EuRoC or TUM-VI", is_sensor_yaml, read_alone};

}  // namespace penumbra::slam
