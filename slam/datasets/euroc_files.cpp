#include "slam/datasets/euroc_files.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/file.h"
#include "nn/io/image_container.h"
#include "nn/io/number_file.h"
#include "slam/datasets/camera_file.h"
#include "slam/datasets/known_keys.h"
#include "slam/datasets/yaml_file.h"
#include "slam/geometry/trajectory_io.h"

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
  const std::string model = yaml.text_or("camera_model", "pinhole");
  if (model != "pinhole")
    throw InputError(yaml.place("camera_model"), "pinhole", fmt::format("'{}'", printable(model, 40)));
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

Trajectory read_euroc_ground_truth(const fs::path& path) {
  std::string text = nn::read_text_file(path, "ground truth (NANOSECONDS,x,y,z,qw,qx,qy,qz,... a line)");
  std::replace(text.begin(), text.end(), ',', ' ');
  Trajectory truth;
  int line = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t stop = std::min(text.find('\n', start), text.size());
    const std::string_view content = std::string_view(text).substr(start, stop - start);
    start = stop + 1;
    ++line;
    const std::size_t first = content.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || content[first] == '#') continue;
    const std::string place = fmt::format("{}:{}", path.string(), line);
    const std::vector<double> v = nn::parse_numbers(content, place);
    if (v.size() < 8) throw InputError(place, "at least 8 numbers", fmt::format("{}", v.size()));
    TimedPose pose;
    pose.timestamp = 1e-9 * v[0];  // exact to a microsecond
    Eigen::Quaterniond q(v[4], v[5], v[6], v[7]);
    if (!(std::abs(q.norm() - 1.0) <= kRotationTolerance)) {
      throw InputError(place, "a quaternion of length 1", fmt::format("length {:g}", q.norm()));
    }
    pose.T_wc = {q.normalized().toRotationMatrix(), {v[1], v[2], v[3]}};
    if (!truth.empty() && pose.timestamp < truth.back().timestamp) {
      throw InputError(place, fmt::format("a time after {:.6f} s", truth.back().timestamp),
                       fmt::format("{:.6f} s", pose.timestamp));
    }
    truth.push_back(pose);
  }
  if (truth.empty()) throw InputError(path.string(), "poses", "none");
  return truth;
}

}  // namespace penumbra::slam
