#include <initializer_list>

#include "nn/base/error.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

// The names that stereoCalibrate's users give its results: of OpenCV's sample, of its documentation, others.
struct OpencvNames {
  std::initializer_list<const char*> matrix, distortion;
};
const OpencvNames kLeftNames = {
    {"K1", "M1", "cameraMatrix1", "camera_matrix_1", "left_camera_matrix", "K_left"},
    {"D1", "distCoeffs1", "dist_coeffs_1", "left_distortion_coefficients", "D_left"}};
const OpencvNames kRightNames = {
    {"K2", "M2", "cameraMatrix2", "camera_matrix_2", "right_camera_matrix", "K_right"},
    {"D2", "distCoeffs2", "dist_coeffs_2", "right_distortion_coefficients", "D_right"}};

// The first of `names` that the file has; the first of all where it has none.
std::string found_name(const YamlFile& yaml, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (yaml.has(name)) return name;
  }
  return *names.begin();
}

bool is_opencv_storage(const YamlFile& yaml) {
  return yaml.has(found_name(yaml, kLeftNames.matrix)) && yaml.has(found_name(yaml, kRightNames.matrix));
}

LensCamera read_opencv_lens(const YamlFile& yaml, const OpencvNames& names) {
  LensCamera lens;
  const std::string matrix = matrix_key(yaml, found_name(yaml, names.matrix));
  set_intrinsics(lens, yaml.numbers(matrix, 9), yaml.place(matrix));
  const std::string key = matrix_key(yaml, found_name(yaml, names.distortion));
  const std::vector<double> distortion = yaml.numbers(key);
  set_lens_model(lens, lens_model_name(LensModel::radial_tangential, distortion.size()), distortion,
                 yaml.place(key));
  return lens;
}

// [width, height], or one by one; not all files have it.
void read_opencv_size(const YamlFile& yaml, LensCamera& lens) {
  const std::string size = found_name(yaml, {"image_size", "imageSize", "size", "img_size"});
  const std::string width = found_name(yaml, {"image_width", "width", "imageWidth"}),
                    height = found_name(yaml, {"image_height", "height", "imageHeight"});
  if (yaml.has(size)) {
    const std::string key = matrix_key(yaml, size);
    const std::vector<double> numbers = yaml.numbers(key, 2);
    set_size(lens, numbers[0], numbers[1], yaml.place(key));
  } else if (yaml.has(width)) {
    set_size(lens, yaml.number(width), yaml.number(height), yaml.place(width));
  }
}

CameraFile read_opencv_storage(const YamlFile& yaml) {
  CameraFile file;
  file.rectified = false;
  file.left = read_opencv_lens(yaml, kLeftNames);
  file.right = read_opencv_lens(yaml, kRightNames);
  read_opencv_size(yaml, file.left);
  read_opencv_size(yaml, file.right);
  const std::string R = matrix_key(yaml, found_name(yaml, {"R", "rotation", "rotation_matrix"})),
                    T = matrix_key(yaml, found_name(yaml, {"T", "translation", "translation_vector"}));
  file.T_right_left = rigid_motion(yaml.numbers(R, 9), yaml.numbers(T, 3), yaml.place(R));
  file.place = yaml.place(T);
  return file;
}

}  // namespace

const CalibrationDialect kOpencvStorage = {"OpenCV's FileStorage of stereoCalibrate", is_opencv_storage,
                                           read_opencv_storage};

}  // namespace penumbra::slam
