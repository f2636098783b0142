#include <algorithm>

#include "nn/base/error.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

bool is_camera_info(const YamlFile& yaml) {
  return yaml.has("projection_matrix") && yaml.has("camera_matrix");
}

LensCamera read_camera_info_lens(const YamlFile& yaml) {
  LensCamera lens;
  const std::string K = matrix_key(yaml, "camera_matrix"), D = matrix_key(yaml, "distortion_coefficients");
  set_intrinsics(lens, yaml.numbers(K, 9), yaml.place(K));
  set_size(lens, yaml.number("image_width"), yaml.number("image_height"), yaml.place("image_width"));
  const std::vector<double> distortion = yaml.has(D) ? yaml.numbers(D) : std::vector<double>();
  if (std::any_of(distortion.begin(), distortion.end(), [](double c) { return c != 0.0; }))
    set_lens_model(lens, yaml.text("distortion_model"), distortion, yaml.place(D));
  return lens;
}

// From the raw camera's frame to the rectified one's.
Eigen::Matrix3d read_rectification(const YamlFile& yaml) {
  const std::string R = matrix_key(yaml, "rectification_matrix");
  return rigid_motion(yaml.numbers(R, 9), {0.0, 0.0, 0.0}, yaml.place(R)).rotation;
}

// Metres along the rows from the left camera to this one; 0 of the left one itself.
double read_base(const YamlFile& yaml) {
  const std::string P = matrix_key(yaml, "projection_matrix");
  const std::vector<double> p = yaml.numbers(P, 12);
  if (!(p[0] > 0.0)) throw InputError(yaml.place(P), "a focal length > 0", fmt::format("{:g}", p[0]));
  return -p[3] / p[0];
}

CameraFile read_camera_info(const YamlFile& yaml) {
  CameraFile file;
  file.left = read_camera_info_lens(yaml);
  if (read_base(yaml) != 0.0) {
    throw InputError(yaml.place(matrix_key(yaml, "projection_matrix")),
                     "the left camera, or both files, the left one first",
                     "the right one of a pair by itself");
  }
  take_for_rgbd(file, yaml.place("image_width"));
  return file;
}

}  // namespace

CameraFile read_camera_info_pair(const YamlFile& left, const YamlFile& right) {
  CameraFile file;
  file.rectified = false;
  file.left = read_camera_info_lens(left);
  file.right = read_camera_info_lens(right);
  const std::string P = matrix_key(right, "projection_matrix");
  file.place = right.place(P);
  const double base = read_base(right) - read_base(left);
  if (!(base > 0.0)) {
    throw InputError(file.place, "a projection matrix with -fx baseline in place 4 (the right camera's)",
                     fmt::format("a baseline of {:g} m; are left and right exchanged?", base));
  }
  file.T_right_left = motion_of_rectified(read_rectification(left), read_rectification(right), base);
  return file;
}

const CalibrationDialect kCameraInfo = {"ROS's camera_info", is_camera_info, read_camera_info};

}  // namespace penumbra::slam
