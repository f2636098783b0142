#include "slam/sources/calibration/calibration.h"

#include <fmt/ranges.h>

#include <array>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/calibration/calibration_writer.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

const CalibrationDialect* spoken_in(const YamlFile& yaml) {
  for (const CalibrationDialect* dialect :
       {&kKalibr, &kOrbSlam, &kCameraInfo, &kOpencvStorage, &kSensorYaml}) {
    if (dialect->is_spoken(yaml)) return dialect;
  }
  return nullptr;
}

Calibration read_one(const std::filesystem::path& path) {
  const std::string text = nn::read_text_file(path, "a calibration");
  if (text.find("\"T_imu_cam\"") != std::string::npos) return {"Basalt", read_basalt(path)};
  if (text.find(':') == std::string::npos) return {"ETH3D's calibration.txt", read_eth3d(path)};
  if (const YamlFile yaml(path); const CalibrationDialect* dialect = spoken_in(yaml))
    return {std::string(dialect->name), dialect->read(yaml)};
  return {"Penumbra", read_own_camera_file(path)};
}

Calibration read_pair(const std::filesystem::path& left, const std::filesystem::path& right) {
  const YamlFile first(left), second(right);
  const CalibrationDialect* dialect = spoken_in(first);
  if (dialect != spoken_in(second) || (dialect != &kCameraInfo && dialect != &kSensorYaml)) {
    throw InputError(left.string() + ", " + right.string(),
                     "two files of ROS's camera_info, or two sensor.yaml, the left camera's first",
                     dialect == nullptr ? "others" : dialect->name);
  }
  return {std::string(dialect->name), dialect == &kCameraInfo ? read_camera_info_pair(first, second)
                                                              : read_sensor_yaml_pair(left, right)};
}

std::string lens_text(const LensCamera& lens, std::string_view indent) {
  std::string text = fmt::format("{0}fx: {1}\n{0}fy: {2}\n{0}cx: {3}\n{0}cy: {4}\n", indent, lens.fx, lens.fy,
                                 lens.cx, lens.cy);
  if (!lens.distortion.empty()) {
    text +=
        fmt::format("{0}distortion_model: {1}\n{0}distortion: [{2}]\n", indent,
                    lens_model_name(lens.model, lens.distortion.size()), fmt::join(lens.distortion, ", "));
  }
  return text;
}

std::string rows_text(const SE3& T) {
  std::string text;
  for (int row = 0; row < 3; ++row)
    text += fmt::format("- [{}, {}, {}, {}]\n", T.rotation(row, 0), T.rotation(row, 1), T.rotation(row, 2),
                        T.translation[row]);
  return text;
}

}  // namespace

Calibration read_calibration(const std::vector<std::filesystem::path>& files) {
  if (files.size() == 2) return read_pair(files[0], files[1]);
  if (files.size() != 1) throw UsageError("calibration: expected one file or two");
  try {
    return read_one(files.front());
  } catch (const InputError& error) {
    const std::string writer = calibration_writer(files.front());
    if (writer.empty()) throw;
    throw InputError(files.front().string(), "a calibration as docs/datasets.md describes it",
                     fmt::format("what looks like {}. {}", writer, error.what()));
  }
}

CameraFile read_camera_file(const std::filesystem::path& path) { return read_calibration({path}).camera; }

std::string calibration_text(const CameraFile& camera) {
  std::string text = fmt::format("sensor: {}\n", camera.sensor == Sensor::rgbd ? "rgbd" : "stereo");
  if (camera.left.width > 0)
    text += fmt::format("width: {}\nheight: {}\n", camera.left.width, camera.left.height);
  if (camera.rectified) {
    text += lens_text(camera.left, "");
    text += fmt::format("baseline: {}\n", camera.baseline);
  } else {
    const auto side = [](const LensCamera& lens) {
      return lens_text(lens, "  ") + (lens.distortion.empty() ? "  distortion_model: none\n" : "");
    };
    text += fmt::format("rectified: false\nleft:\n{}right:\n{}T_right_left:\n{}", side(camera.left),
                        side(camera.right), rows_text(camera.T_right_left));
  }
  if (!camera.mountings.empty()) {
    const Mounting& mounting = camera.mountings.front();
    text += fmt::format("body: {}\nT_body_left:\n{}", mounting.frame, rows_text(mounting.T_frame_camera));
  }
  if (camera.sensor == Sensor::rgbd) text += fmt::format("depth_factor: {}\n", camera.depth_factor);
  if (camera.colour) text += fmt::format("colour: {}\n", *camera.colour);
  if (camera.frame_rate) text += fmt::format("rate: {}\n", *camera.frame_rate);
  return text;
}

}  // namespace penumbra::slam
