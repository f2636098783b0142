#include "slam/sources/calibration/calibration_writer.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::slam {

namespace {

struct Writer {
  const char* name;
  std::vector<std::string_view> marks;  // texts of which one is in its files and in no others
};

const std::vector<Writer>& writers() {
  static const std::vector<Writer> list = {
      {"Basalt's calibration (JSON)", {"\"T_imu_cam\""}},
      {"a JSON file", {}},
      {"Kalibr's camchain", {"T_cn_cnm1", "cam_overlaps", "T_cam_imu", "rostopic"}},
      {"ORB-SLAM's settings", {"Camera.type", "Camera1.fx", "Camera.fx", "ORBextractor.", "Stereo.b:"}},
      {"ROS's camera_info", {"projection_matrix:", "rectification_matrix:"}},
      {"the settings of VINS", {"projection_parameters:", "body_T_cam0"}},
      {"stella_vslam's settings", {"Camera:", "Feature:"}},
      {"OpenCV's FileStorage", {"!!opencv-matrix"}},
      {"EuRoC's sensor.yaml", {"T_BS:"}},
  };
  return list;
}

}  // namespace

std::string calibration_writer(const std::filesystem::path& path) {
  std::string text;
  try {
    text = nn::read_text_file(path, "a calibration");
  } catch (const InputError&) {
    return {};
  }
  const std::size_t first = text.find_first_not_of(" \t\n");
  const bool is_json = first != std::string::npos && (text[first] == '{' || text.substr(first, 2) == "[{");
  for (const Writer& writer : writers()) {
    const bool has_mark = std::any_of(writer.marks.begin(), writer.marks.end(), [&](std::string_view mark) {
      return text.find(mark) != std::string::npos;
    });
    if (has_mark || (writer.marks.empty() && is_json)) return writer.name;
  }
  return {};
}

}  // namespace penumbra::slam
