#include "slam/geometry/rectification.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

cv::Mat intrinsics_of(const LensCamera& c) {
  return (cv::Mat_<double>(3, 3) << c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
}

cv::Mat distortion_of(const LensCamera& c) {
  const std::size_t least = 4;
  cv::Mat distortion = cv::Mat::zeros(static_cast<int>(std::max(least, c.distortion.size())), 1, CV_64F);
  for (std::size_t i = 0; i < c.distortion.size(); ++i)
    distortion.at<double>(static_cast<int>(i)) = c.distortion[i];
  return distortion;
}

cv::Mat to_cv(const Eigen::Matrix3d& R) {
  cv::Mat out(3, 3, CV_64F);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.at<double>(r, c) = R(r, c);
  }
  return out;
}

Eigen::Matrix3d to_eigen(const cv::Mat& R) {
  Eigen::Matrix3d out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out(r, c) = R.at<double>(r, c);
  }
  return out;
}

// What OpenCV refuses is no camera.
template <class Compute>
void compute(const std::string& place, const Compute& action) {
  try {
    action();
  } catch (const cv::Exception& error) {
    throw InputError(place, "lenses whose images can be made those of pinhole cameras", printable(error.err));
  }
}

ImageRemap make_remap(const LensCamera& camera, const cv::Mat& R, const cv::Mat& P) {
  const cv::Size size(camera.width, camera.height);
  cv::Mat map_x, map_y;
  if (camera.model == LensModel::equidistant) {
    cv::fisheye::initUndistortRectifyMap(intrinsics_of(camera), distortion_of(camera), R, P, size, CV_32FC1,
                                         map_x, map_y);
  } else {
    cv::initUndistortRectifyMap(intrinsics_of(camera), distortion_of(camera), R, P, size, CV_32FC1, map_x,
                                map_y);
  }
  return {map_x, map_y};
}

// A camera whose matrix P is; the size is that of the real one.
StereoCamera pinhole_of(const cv::Mat& P, const LensCamera& lens, const std::string& place) {
  StereoCamera camera;
  camera.fx = P.at<double>(0, 0);
  camera.fy = P.at<double>(1, 1);
  camera.cx = P.at<double>(0, 2);
  camera.cy = P.at<double>(1, 2);
  camera.width = lens.width;
  camera.height = lens.height;
  const bool possible = std::isfinite(camera.fx) && camera.fx > 0.0 && std::isfinite(camera.fy) &&
                        camera.fy > 0.0 && std::isfinite(camera.cx) && std::isfinite(camera.cy) &&
                        camera.fx < 100.0 * lens.fx;
  if (!possible) {
    throw InputError(place, "lenses whose images can be made those of pinhole cameras",
                     fmt::format("fx {:g} fy {:g} cx {:g} cy {:g} after rectification", camera.fx, camera.fy,
                                 camera.cx, camera.cy));
  }
  return camera;
}

}  // namespace

ImageRemap::ImageRemap(const cv::Mat& map_x, const cv::Mat& map_y) {
  cv::convertMaps(map_x, map_y, linear_, weights_, CV_16SC2, false);
  cv::Mat unused;
  cv::convertMaps(map_x, map_y, nearest_, unused, CV_16SC2, true);
}

cv::Mat ImageRemap::apply(const cv::Mat& image) const {
  if (is_identity()) return image;
  cv::Mat out;
  cv::remap(image, out, linear_, weights_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat ImageRemap::apply_nearest(const cv::Mat& depth) const {
  if (is_identity()) return depth;
  cv::Mat out;
  cv::remap(depth, out, nearest_, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(0));
  return out;
}

StereoRectification rectify_stereo(const LensCamera& left, const LensCamera& right, const SE3& T_right_left,
                                   const std::string& place) {
  if (left.width != right.width || left.height != right.height) {
    throw InputError(place, fmt::format("two cameras of the same size, {} x {}", left.width, left.height),
                     fmt::format("{} x {}", right.width, right.height));
  }
  if (left.model != right.model) {
    throw InputError(place, "two cameras of the same distortion model", "different ones");
  }
  const Eigen::Vector3d b = T_right_left.inverse().translation;  // the right camera's centre
  if (!(b.x() > std::abs(b.y()) && b.x() > std::abs(b.z()))) {
    throw InputError(
        place, "a second camera to the right of the first (baseline along +x)",
        fmt::format("one at ({:.4g}, {:.4g}, {:.4g}) m: are they swapped?", b.x(), b.y(), b.z()));
  }
  const cv::Size size(left.width, left.height);
  const cv::Mat t = (cv::Mat_<double>(3, 1) << T_right_left.translation.x(), T_right_left.translation.y(),
                     T_right_left.translation.z());
  cv::Mat R1, R2, P1, P2, Q;
  compute(place, [&] {
    const cv::Mat R = to_cv(T_right_left.rotation);
    if (left.model == LensModel::equidistant) {
      cv::fisheye::stereoRectify(intrinsics_of(left), distortion_of(left), intrinsics_of(right),
                                 distortion_of(right), size, R, t, R1, R2, P1, P2, Q,
                                 cv::CALIB_ZERO_DISPARITY, size, 0.0, 1.0);
    } else {
      cv::stereoRectify(intrinsics_of(left), distortion_of(left), intrinsics_of(right), distortion_of(right),
                        size, R, t, R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
    }
  });
  StereoRectification result;
  result.camera = pinhole_of(P1, left, place);
  result.camera.baseline = b.norm();
  result.left = make_remap(left, R1, P1);
  result.right = make_remap(right, R2, P2);
  result.R_rectified_left = to_eigen(R1);
  return result;
}

Undistortion undistort(const LensCamera& camera, const std::string& place) {
  Undistortion result;
  if (camera.distortion.empty()) {
    result.camera = pinhole_of(intrinsics_of(camera), camera, place);
    return result;
  }
  const cv::Size size(camera.width, camera.height);
  cv::Mat P;
  compute(place, [&] {
    const cv::Mat K = intrinsics_of(camera), distortion = distortion_of(camera);
    if (camera.model == LensModel::equidistant) {
      const cv::Mat no_turn = cv::Mat::eye(3, 3, CV_64F);
      cv::fisheye::estimateNewCameraMatrixForUndistortRectify(K, distortion, size, no_turn, P, 0.0, size);
    } else {
      P = cv::getOptimalNewCameraMatrix(K, distortion, size, 0.0, size);
    }
  });
  result.camera = pinhole_of(P, camera, place);
  result.remap = make_remap(camera, cv::Mat::eye(3, 3, CV_64F), P);
  return result;
}

}  // namespace penumbra::slam
