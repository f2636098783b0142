// Makes a rectified pair of pinhole images from what two real lenses see, or a pinhole image from one.
//
// Distortion models, from the direction (x, y, 1) of a point to the place (x', y') in the normalised image,
// r^2 = x^2 + y^2:
//
//   radial-tangential  x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
//   (k1 k2 p1 p2 [k3]) y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
//   equidistant        (x', y') = (x, y) theta_d / r,  theta = atan r,
//   (k1 k2 k3 k4)      theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//
// Rectifying turns both cameras by half their relative rotation and so that their rows lie along the baseline
// (Bouguet); the common focal length is the smallest at which every pixel of the results comes from inside
// both images. The remap tables are made once, with OpenCV's calib3d, and applied with linear interpolation.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

enum class LensModel { radial_tangential, equidistant };

// A real camera: pixel = K (x', y').
struct LensCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  LensModel model = LensModel::radial_tangential;
  std::vector<double> distortion;  // 4 or 5 coefficients in the order above; none: no distortion
  int width = 0, height = 0;       // pixels
};

// Where each pixel of the result comes from.
class ImageRemap {
 public:
  ImageRemap() = default;  // leaves images as they are
  ImageRemap(const cv::Mat& map_x, const cv::Mat& map_y);
  bool is_identity() const { return linear_.empty(); }
  cv::Mat apply(const cv::Mat& image) const;  // linear
  // Depth is not mixed over an edge: the nearest pixel's.
  cv::Mat apply_nearest(const cv::Mat& depth) const;

 private:
  cv::Mat linear_, weights_, nearest_;
};

struct StereoRectification {
  StereoCamera camera;
  ImageRemap left, right;
  Eigen::Matrix3d R_rectified_left = Eigen::Matrix3d::Identity();  // from the real left camera
};

// Throws InputError naming `place` where the cameras cannot be rectified: of different sizes, the right one
// not to the right (the baseline, in the left camera's frame, must point along +x more than along y or z), no
// usable image left.
StereoRectification rectify_stereo(const LensCamera& left, const LensCamera& right, const SE3& T_right_left,
                                   const std::string& place);

struct Undistortion {
  StereoCamera camera;  // without baseline
  ImageRemap remap;
};

// Without distortion the camera comes back as it is. Throws InputError where no usable image is left.
Undistortion undistort(const LensCamera& camera, const std::string& place);

}  // namespace penumbra::slam
