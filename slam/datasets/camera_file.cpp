#include "slam/datasets/camera_file.h"

#include <fmt/core.h>

#include <cmath>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/image_container.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::slam {

namespace {

int read_pixels(const YamlFile& yaml, const std::string& key) {
  if (!yaml.has(key)) return 0;
  const double value = yaml.number_above_zero(key);
  if (value != std::floor(value) || value > 65535.0) {
    throw InputError(yaml.place(key), "a whole number of pixels", fmt::format("{:g}", value));
  }
  return static_cast<int>(value);
}

void read_size(const YamlFile& yaml, int& width, int& height) {
  width = read_pixels(yaml, "width");
  height = read_pixels(yaml, "height");
  if ((width > 0) != (height > 0)) throw InputError(yaml.place("width"), "width and height", "one of them");
  if (static_cast<long>(width) * height > nn::kMaxImagePixels) {
    throw InputError(yaml.place("width"), "an image that can be", fmt::format("{} x {}", width, height));
  }
}

// fx, fy, cx, cy and the distortion, where there is one; `prefix` is "left." or "right.", or "".
LensCamera read_lens(const YamlFile& yaml, const std::string& prefix) {
  LensCamera lens;
  read_size(yaml, lens.width, lens.height);
  lens.fx = yaml.number_above_zero(prefix + "fx");
  lens.fy = yaml.number_above_zero(prefix + "fy");
  lens.cx = yaml.number(prefix + "cx");
  lens.cy = yaml.number(prefix + "cy");
  const std::string distortion = prefix + "distortion";
  if (yaml.has(distortion)) {
    set_lens_model(lens, yaml.text_or(prefix + "distortion_model", "radial-tangential"),
                   yaml.numbers(distortion), yaml.place(distortion));
    if (lens.width == 0) {
      throw InputError(yaml.place(distortion), "width and height of the images, to undo the distortion",
                       "neither");
    }
  }
  return lens;
}

void read_stereo(const YamlFile& yaml, CameraFile& file) {
  file.rectified = !yaml.has("rectified") || yaml.flag("rectified");
  if (file.rectified) {
    file.left = read_lens(yaml, "");
    file.baseline = yaml.number_above_zero("baseline");
    if (!file.left.distortion.empty()) {
      throw InputError(yaml.place("distortion"), "no distortion in rectified images (or 'rectified: false')",
                       "coefficients");
    }
    return;
  }
  file.left = read_lens(yaml, "left.");
  file.right = read_lens(yaml, "right.");
  file.T_right_left = read_transform(yaml, "T_right_left");
  file.place = yaml.place("T_right_left");
  if (file.left.width == 0) {
    throw InputError(yaml.place("width"), "width and height of the images, to rectify them", "neither");
  }
}

void read_rgbd(const YamlFile& yaml, CameraFile& file) {
  file.left = read_lens(yaml, "");
  file.baseline = yaml.has("baseline") ? yaml.number_above_zero("baseline") : kNominalBaseline;
  file.depth_factor = yaml.number_above_zero("depth_factor");
}

}  // namespace

SE3 read_transform(const YamlFile& yaml, const std::string& key) {
  const std::vector<double> v = yaml.numbers(key);
  if (v.size() != 12 && v.size() != 16) {
    throw InputError(yaml.place(key), "12 or 16 numbers (a rigid motion, row by row)",
                     fmt::format("{}", v.size()));
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
    throw InputError(yaml.place(key), "a rotation and a translation (last row 0 0 0 1)",
                     fmt::format("a matrix that is off by {:g}", skewness));
  }
  T.normalize();
  return T;
}

CameraFile read_camera_file(const std::filesystem::path& path) {
  const YamlFile yaml(path);
  CameraFile file;
  file.place = path.string();
  const std::string sensor = yaml.text_or("sensor", yaml.has("depth_factor") ? "rgbd" : "stereo");
  if (sensor == "rgbd") {
    file.sensor = Sensor::rgbd;
    read_rgbd(yaml, file);
  } else if (sensor == "stereo") {
    read_stereo(yaml, file);
  } else {
    throw InputError(yaml.place("sensor"), "stereo or rgbd", fmt::format("'{}'", printable(sensor, 40)));
  }
  if (yaml.has("colour")) file.colour = yaml.flag("colour");
  if (yaml.has("rate")) file.frame_rate = yaml.number_above_zero("rate");
  return file;
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
  return made;
}

}  // namespace penumbra::slam
