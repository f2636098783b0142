#include "slam/sources/calibration/camera_file.h"

#include <fmt/core.h>

#include <cmath>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/calibration/camera_keys.h"
#include "slam/sources/calibration/lens_reader.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

// Refuses keys that would be of no effect where they stand.
void refuse(const YamlFile& yaml, std::string_view expected, std::initializer_list<const char*> keys) {
  for (const std::string& key : yaml.keys()) {
    for (const char* refused : keys) {
      if (key == refused || key.starts_with(std::string(refused) + "."))
        throw InputError(yaml.place(key), expected, fmt::format("'{}'", printable(key, 40)));
    }
  }
}

// In metres: that of the file, as it is or times fx; `otherwise` where the file may do without.
double read_baseline(const YamlFile& yaml, double fx, std::optional<double> otherwise) {
  const std::string key = one_of(yaml, {"baseline", "bf"});
  if (otherwise && !yaml.has(key)) return *otherwise;
  const double baseline = yaml.number_above_zero(key) / (key == "bf" ? fx : 1.0);
  if (!(baseline > 0.0 && std::isfinite(baseline)))
    throw InputError(yaml.place(key), "a baseline above 0", fmt::format("{:g} m", baseline));
  return baseline;
}

// Of a raw lens: most have a distortion that matters, so that a file must say where one has none.
void require_distortion(const YamlFile& yaml, const std::string& prefix) {
  for (const char* key : {"distortion", "k1", "distortion_model"}) {
    if (yaml.has(prefix + key)) return;
  }
  throw InputError(yaml.place(prefix + "distortion"),
                   fmt::format("{0}distortion of the raw lens, or '{0}distortion_model: none'", prefix),
                   "neither");
}

void read_stereo(const YamlFile& yaml, CameraFile& file) {
  refuse(yaml, "sensor: rgbd for a camera with depth", {"depth_factor", "depth_scale"});
  file.rectified = !yaml.has("rectified") || yaml.flag("rectified");
  if (file.rectified) {
    refuse(yaml, "rectified: false for two raw cameras", {"left", "right", "T_right_left", "T_left_right"});
    file.left = read_lens(yaml, "");
    file.baseline = read_baseline(yaml, file.left.fx, std::nullopt);
    if (!file.left.distortion.empty()) {
      throw InputError(yaml.place(yaml.has("distortion") ? "distortion" : "k1"),
                       "no distortion in rectified images (or 'rectified: false')", "coefficients");
    }
    return;
  }
  refuse(yaml, "left: and right: with the values of each raw camera",
         {"fx", "fy", "cx", "cy", "intrinsics", "camera_matrix", "camera_model", "distortion",
          "distortion_model", "k1", "k2", "k3", "k4", "p1", "p2"});
  refuse(yaml, "T_right_left, which holds the baseline", {"baseline", "bf"});
  file.left = read_lens(yaml, "left.");
  file.right = read_lens(yaml, "right.");
  for (const char* side : {"left.", "right."}) require_distortion(yaml, side);
  const std::string key = one_of(yaml, {"T_right_left", "T_left_right"});
  file.T_right_left = read_transform(yaml, key);
  if (key == "T_left_right") file.T_right_left = file.T_right_left.inverse();
  file.place = yaml.place(key);
  if (file.left.width == 0) {
    throw InputError(yaml.place("width"), "width and height of the images, to rectify them", "neither");
  }
}

// Where the left camera stands on its body, of which a file may say the name.
void read_mounting(const YamlFile& yaml, CameraFile& file) {
  const bool is_inverse = yaml.has("T_left_body");
  if (!is_inverse && !yaml.has("T_body_left") && !yaml.has("body")) return;
  const std::string key = one_of(yaml, {"T_body_left", "T_left_body"});
  const SE3 T = read_transform(yaml, key);
  file.mountings.push_back({yaml.text_or("body", "body"), is_inverse ? T.inverse() : T});
}

// Levels a metre. A depth_scale below 1 is the metres of a level, as RealSense's tools have it.
double read_depth_factor(const YamlFile& yaml) {
  const std::string key = one_of(yaml, {"depth_factor", "depth_scale"});
  const double value = yaml.number_above_zero(key);
  if (value >= 1.0) return value;
  constexpr double kFinest = 1e-6;  // metres a level; finer is no camera's
  if (key == "depth_scale" && value >= kFinest) return 1.0 / value;
  throw InputError(yaml.place(key), fmt::format("levels a metre, at least 1 (such as {:g})", 1.0 / value),
                   fmt::format("{:g}", value));
}

void read_rgbd(const YamlFile& yaml, CameraFile& file) {
  refuse(yaml, "sensor: stereo for two cameras",
         {"left", "right", "T_right_left", "T_left_right", "rectified"});
  file.left = read_lens(yaml, "");
  file.baseline = read_baseline(yaml, file.left.fx, kNominalBaseline);
  file.depth_factor = read_depth_factor(yaml);
}

}  // namespace

SE3 read_transform(const YamlFile& yaml, const std::string& key) {
  return rigid_motion(yaml.numbers(key), yaml.place(key));
}

SE3 rigid_motion(const std::vector<double>& v, const std::string& place) {
  if (v.size() != 12 && v.size() != 16) {
    throw InputError(place, "12 or 16 numbers (a rigid motion, row by row)", fmt::format("{}", v.size()));
  }
  SE3 T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      T.rotation(row, column) = v[static_cast<std::size_t>(4 * row + column)];
    T.translation[row] = v[static_cast<std::size_t>(4 * row + 3)];
  }
  const double skewness =
      (T.rotation * T.rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row = v.size() == 12 || (v[12] == 0.0 && v[13] == 0.0 && v[14] == 0.0 && v[15] == 1.0);
  if (!(skewness <= kRotationTolerance) || T.rotation.determinant() < 0.0 || !last_row) {
    throw InputError(place, "a rotation and a translation (last row 0 0 0 1)",
                     fmt::format("a matrix that is off by {:g}", skewness));
  }
  T.normalize();
  return T;
}

SE3 rigid_motion(const std::vector<double>& R, const std::vector<double>& t, const std::string& place) {
  return rigid_motion({R.at(0), R.at(1), R.at(2), t.at(0), R.at(3), R.at(4), R.at(5), t.at(1), R.at(6),
                       R.at(7), R.at(8), t.at(2)},
                      place);
}

SE3 motion_of_rectified(const Eigen::Matrix3d& R_left, const Eigen::Matrix3d& R_right, double baseline) {
  return {R_right.transpose() * R_left, R_right.transpose() * Eigen::Vector3d(-baseline, 0.0, 0.0)};
}

void take_for_rgbd(CameraFile& file, const std::string& place) {
  file.sensor = Sensor::rgbd;
  file.baseline = kNominalBaseline;
  file.depth_factor = 1000.0;
  file.place = place;
  file.notes.emplace_back(
      "the calibration is of one camera: taken for an RGB-D camera's whose depths are millimetres "
      "(depth_factor "
      "1000)");
}

void take_size(const Size& image, CameraFile& file) {
  if (file.left.width > 0) return;
  file.left.width = file.right.width = image.width;
  file.left.height = file.right.height = image.height;
  if (file.rectified) return;
  file.notes.emplace_back(
      "the calibration does not say the size of its images: that of the first one is taken");
}

CameraFile read_own_camera_file(const std::filesystem::path& path) {
  YamlFile yaml(path);
  use_camera_keys(yaml);
  CameraFile file;
  file.place = path.string();
  const std::string written =
      yaml.text_or("sensor", yaml.has("depth_factor") || yaml.has("depth_scale") ? "rgbd" : "stereo");
  const std::string sensor = plain_word(written);
  if (sensor == "rgbd") {
    file.sensor = Sensor::rgbd;
    read_rgbd(yaml, file);
  } else if (sensor == "stereo") {
    read_stereo(yaml, file);
  } else {
    throw InputError(yaml.place("sensor"), "stereo or rgbd", in_quotes(written));
  }
  read_mounting(yaml, file);
  if (yaml.has("colour")) file.colour = yaml.flag("colour");
  if (yaml.has("rate")) file.frame_rate = yaml.number_above_zero("rate");
  return file;
}

void RecordedCamera::stands(const Mounting& of_left) {
  const SE3 T_left_rectified{R_rectified_left.transpose(), Eigen::Vector3d::Zero()};
  mountings.push_back({of_left.frame, of_left.T_frame_camera * T_left_rectified});
}

RecordedCamera make_camera(const CameraFile& file) {
  RecordedCamera made;
  if (file.rectified) {
    Undistortion undistortion = undistort(file.left, file.place);
    made.camera = undistortion.camera;
    made.camera.baseline = file.baseline;
    made.left = undistortion.remap;
  } else {
    StereoRectification r = rectify_stereo(file.left, file.right, file.T_right_left, file.place);
    made.camera = r.camera;
    made.left = r.left;
    made.right = r.right;
    made.R_rectified_left = r.R_rectified_left;
  }
  for (const Mounting& mounting : file.mountings) made.stands(mounting);
  return made;
}

}  // namespace penumbra::slam
