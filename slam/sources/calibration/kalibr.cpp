#include <fmt/core.h>

#include "nn/base/error.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

bool is_kalibr(const YamlFile& yaml) { return yaml.has("cam0.intrinsics"); }

LensCamera read_kalibr_lens(const YamlFile& yaml, const std::string& camera) {
  LensCamera lens;
  require_pinhole(yaml, camera + "camera_model");
  set_intrinsics(lens, yaml.numbers(camera + "intrinsics", 4), yaml.place(camera + "intrinsics"));
  const std::vector<double> size = yaml.numbers(camera + "resolution", 2);
  set_size(lens, size[0], size[1], yaml.place(camera + "resolution"));
  const std::string model = yaml.text(camera + "distortion_model");
  if (model != "none") {
    set_lens_model(lens, model, yaml.numbers(camera + "distortion_coeffs"),
                   yaml.place(camera + "distortion_coeffs"));
  }
  return lens;
}

// From the neighbour in the chain, or by way of the inertial sensor.
SE3 right_from_left(const YamlFile& yaml, std::string& key) {
  key = "cam1.T_cn_cnm1";
  if (yaml.has(key)) return read_transform(yaml, key);
  for (const char* name : {"T_cam_imu", "T_imu_cam"}) {
    key = fmt::format("cam1.{}", name);
    if (!yaml.has(key)) continue;
    const SE3 left = read_transform(yaml, fmt::format("cam0.{}", name)), right = read_transform(yaml, key);
    return std::string_view(name) == "T_cam_imu" ? right * left.inverse() : right.inverse() * left;
  }
  throw InputError(yaml.place("cam1.intrinsics"),
                   "cam1's T_cn_cnm1, or T_cam_imu or T_imu_cam of both cameras", "none of them");
}

// On the inertial sensor.
void read_mounting_on_imu(const YamlFile& yaml, CameraFile& file) {
  if (yaml.has("cam0.T_cam_imu")) {
    file.mountings.push_back({"imu", read_transform(yaml, "cam0.T_cam_imu").inverse()});
  } else if (yaml.has("cam0.T_imu_cam")) {
    file.mountings.push_back({"imu", read_transform(yaml, "cam0.T_imu_cam")});
  }
}

CameraFile read_kalibr(const YamlFile& yaml) {
  CameraFile file;
  file.left = read_kalibr_lens(yaml, "cam0.");
  read_mounting_on_imu(yaml, file);
  if (!yaml.has("cam1.intrinsics")) {
    take_for_rgbd(file, yaml.place("cam0.intrinsics"));
    return file;
  }
  file.rectified = false;
  file.right = read_kalibr_lens(yaml, "cam1.");
  std::string key;
  file.T_right_left = right_from_left(yaml, key);
  file.place = yaml.place(key);
  if (yaml.has("cam2.intrinsics"))
    file.notes.emplace_back("of more than two cameras cam0 and cam1 are taken");
  return file;
}

}  // namespace

const CalibrationDialect kKalibr = {"Kalibr's camchain", is_kalibr, read_kalibr};

}  // namespace penumbra::slam
