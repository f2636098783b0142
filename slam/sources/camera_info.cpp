#include "slam/sources/camera_info.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/image/image_container.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

bool are_zeros(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
}
bool are_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// The part of the sensor that an image shows, and its pixels.
struct Window {
  double x = 0.0, y = 0.0;    // of its upper left pixel on the sensor
  double by_x = 1, by_y = 1;  // pixels of the sensor a pixel
  int width = 0, height = 0;

  explicit Window(const SaidCamera& said) {
    const CameraInfoMessage& i = said.info;
    by_x = std::max(1U, i.binning_x);
    by_y = std::max(1U, i.binning_y);
    const bool has_roi = i.roi_width > 0 && i.roi_height > 0;
    x = has_roi ? i.roi_x : 0;
    y = has_roi ? i.roi_y : 0;
    const double w = (has_roi ? i.roi_width : i.width) / by_x, h = (has_roi ? i.roi_height : i.height) / by_y;
    constexpr double kLongestSide = 65535.0;
    if (std::max(w, h) > kLongestSide || w * h > static_cast<double>(nn::kMaxImagePixels))
      throw InputError(said.topic, "an image that can be", fmt::format("{} x {}", w, h));
    width = static_cast<int>(w);
    height = static_cast<int>(h);
  }
};

// fx, fy, cx, cy of the sensor, as the image has them.
void set_pinhole(double fx, double fy, double cx, double cy, const Window& window, const std::string& place,
                 auto& camera) {
  if (!(fx > 0.0 && fy > 0.0 && std::isfinite(fx + fy + cx + cy))) {
    throw InputError(place, "a calibrated camera (K[0] above 0), or --camera FILE",
                     fmt::format("fx {:g} fy {:g} cx {:g} cy {:g}", fx, fy, cx, cy));
  }
  camera.fx = fx / window.by_x;
  camera.fy = fy / window.by_y;
  camera.cx = (cx - window.x) / window.by_x;
  camera.cy = (cy - window.y) / window.by_y;
  camera.width = window.width;
  camera.height = window.height;
}

LensCamera raw_lens(const SaidCamera& said) {
  const CameraInfoMessage& i = said.info;
  LensCamera lens;
  set_pinhole(i.K[0], i.K[4], i.K[2], i.K[5], Window(said), said.topic, lens);
  if (are_zeros(i.D)) return lens;
  if (!are_finite(i.D)) throw InputError(said.topic, "finite coefficients D", "others");
  const std::string model = i.model.empty() ? "plumb_bob" : i.model;
  set_lens_model(lens, model, i.D, fmt::format("{}: D", said.topic));
  if (lens.width == 0) throw InputError(said.topic, "width and height, to undo the distortion", "neither");
  return lens;
}

// Of rectified images P is the lens; some drivers leave it out where there is nothing to undo.
LensCamera lens_of(const SaidCamera& said, bool name_says_rectified) {
  const std::array<double, 12>& P = said.info.P;
  if (!name_says_rectified || are_zeros(P)) {
    LensCamera lens = raw_lens(said);
    if (name_says_rectified && !lens.distortion.empty())
      throw InputError(said.topic, "P, as the images are rectified", "zeros");
    return lens;
  }
  LensCamera lens;
  set_pinhole(P[0], P[5], P[2], P[6], Window(said), said.topic, lens);
  return lens;
}

Eigen::Matrix3d matrix_of(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

// By how much it is not orthonormal.
double skewness_of(const Eigen::Matrix3d& R) {
  return (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}
bool is_rotation(const std::array<double, 9>& rows) {
  constexpr double kTolerance = 1e-4;
  const Eigen::Matrix3d R = matrix_of(rows);
  return skewness_of(R) <= kTolerance && R.determinant() > 0.0;
}

Eigen::Matrix3d rotation_of(const SaidCamera& said) {
  if (!is_rotation(said.info.R))
    throw InputError(said.topic, "a rotation R, by which images are rectified (or --camera FILE)",
                     fmt::format("a matrix that is off by {:g}", skewness_of(matrix_of(said.info.R))));
  return matrix_of(said.info.R);
}

// Of rectified images; some drivers leave R out, too.
Eigen::Matrix3d rotation_of_rectified(const SaidCamera& said) {
  return are_zeros(said.info.R) ? Eigen::Matrix3d::Identity() : rotation_of(said);
}

bool has_nothing_to_rectify(const CameraInfoMessage& i) {
  constexpr double kTolerance = 1e-6;
  const auto is_near = [](double a, double b) {
    return std::abs(a - b) <= kTolerance * std::max(1.0, std::abs(b));
  };
  bool is_plain = are_zeros(i.D);
  for (std::size_t k = 0; k < 9; ++k) {
    is_plain = is_plain && is_near(i.R[k], k % 4 == 0 ? 1.0 : 0.0);
    is_plain = is_plain && is_near(i.P[k / 3 * 4 + k % 3], i.K[k]);
  }
  return is_plain;
}

// Metres; P of both is needed.
double baseline_of(const SaidCamera& left, const SaidCamera& right) {
  const std::array<double, 12>&l = left.info.P, &r = right.info.P;
  if (are_zeros(r) || are_zeros(l) || !are_finite(l) || !are_finite(r)) {
    throw InputError(are_zeros(l) ? left.topic : right.topic,
                     "P of a stereo camera, with P[3] = -fx b, or the camera by --camera FILE",
                     are_zeros(l) || are_zeros(r) ? "zeros" : "numbers that are not finite");
  }
  if (std::abs(r[7] - l[7]) > 1e-3 * std::abs(r[3] - l[3]))
    throw InputError(right.topic, "a right camera that is beside the left one (P[7] = 0)",
                     fmt::format("P[7] = {:g}", r[7]));
  const double baseline = (l[3] - r[3]) / r[0];
  if (baseline > 0.0) return baseline;
  throw InputError(right.topic, "P[3] = -fx b, below 0",
                   baseline == 0.0 ? std::string("no baseline: P[3] = 0 (--camera FILE gives one)")
                                   : fmt::format("P[3] = {:g}: are left and right swapped?", r[3]));
}

RecordedCamera camera_of_P(const SaidCamera& left, const SaidCamera& right) {
  const double baseline = baseline_of(left, right);
  const std::array<double, 12>&l = left.info.P, &r = right.info.P;
  RecordedCamera made;
  const Window window(left);
  set_pinhole(l[0], l[5], l[2], l[6], window, left.topic, made.camera);
  made.camera.baseline = baseline;
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-3 * std::max(1.0, std::abs(a)); };
  if (differ(l[0], r[0]) || differ(l[5], r[5]) || std::abs(l[6] - r[6]) > 0.5) {
    throw InputError(right.topic,
                     fmt::format("fx, fy and cy of the left camera's P ({:g} {:g} {:g})", l[0], l[5], l[6]),
                     fmt::format("{:g} {:g} {:g}", r[0], r[5], r[6]));
  }
  // stereoRectify without CALIB_ZERO_DISPARITY: points at infinity lie at another column.
  made.camera.disparity_offset = (l[2] - r[2]) / window.by_x;
  if (is_rotation(left.info.R)) made.R_rectified_left = matrix_of(left.info.R);
  return made;
}

}  // namespace

bool says_rectified(std::string_view topic) {
  constexpr std::string_view kWord = "rect";
  const std::string name = lower_case(topic);
  for (std::size_t at = name.find(kWord); at != std::string::npos; at = name.find(kWord, at + 1)) {
    const bool begins = at == 0 || name[at - 1] == '/' || name[at - 1] == '_';
    const std::string_view rest = std::string_view(name).substr(at + kWord.size());
    if (begins && (rest.empty() || rest[0] == '/' || rest[0] == '_' || rest.starts_with("ified")))
      return true;
  }
  return false;
}

RecordedCamera stereo_camera(const SaidCamera& left, const SaidCamera& right, bool names_say_rectified) {
  if (names_say_rectified || (has_nothing_to_rectify(left.info) && has_nothing_to_rectify(right.info)))
    return camera_of_P(left, right);
  const double baseline = baseline_of(left, right);
  SE3 T_right_left = motion_of_rectified(rotation_of(left), rotation_of(right), baseline);
  T_right_left.normalize();
  return stereo_camera_at(left, right, T_right_left, false);
}

bool has_baseline(const CameraInfoMessage& left, const CameraInfoMessage& right) {
  return !are_zeros(left.P) && !are_zeros(right.P) && left.P[3] != right.P[3];
}

RecordedCamera stereo_camera_at(const SaidCamera& left, const SaidCamera& right, const SE3& T_right_left,
                                bool names_say_rectified) {
  CameraFile file;
  file.rectified = false;
  file.left = lens_of(left, names_say_rectified);
  file.right = lens_of(right, names_say_rectified);
  file.T_right_left = T_right_left;
  file.place = right.topic;
  if (!names_say_rectified) return make_camera(file);
  // Each camera was turned by its R.
  const Eigen::Matrix3d R_left = rotation_of_rectified(left), R_right = rotation_of_rectified(right);
  file.T_right_left = {R_right * T_right_left.rotation * R_left.transpose(),
                       R_right * T_right_left.translation};
  RecordedCamera made = make_camera(file);
  made.R_rectified_left = made.R_rectified_left * R_left;
  return made;
}

RecordedCamera rgbd_camera(const SaidCamera& said, bool name_says_rectified) {
  CameraFile file;
  file.sensor = Sensor::rgbd;
  file.baseline = kNominalBaseline;
  file.place = said.topic;
  file.left = lens_of(said, name_says_rectified);
  return make_camera(file);
}

bool is_same_camera(const CameraInfoMessage& a, const CameraInfoMessage& b) {
  constexpr double kTolerance = 1e-3;
  bool is_same = a.width == b.width && a.height == b.height;
  for (const std::size_t k : {0, 2, 4, 5})
    is_same = is_same && std::abs(a.K[k] - b.K[k]) <= kTolerance * std::max(1.0, std::abs(b.K[k]));
  return is_same;
}

}  // namespace penumbra::slam
