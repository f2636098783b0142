// A real lens: where the image shows a direction, and which direction an image's point shows.
//
// Distortion models, from the direction (x, y, 1) of a point to the place (x', y') in the normalised image,
// r^2 = x^2 + y^2; pixel = (fx x' + cx, fy y' + cy):
//
//   radial-tangential  x' = x q + 2 p1 x y + p2 (r^2 + 2 x^2),  q = 1 + k1 r^2 + k2 r^4 + k3 r^6
//   (k1 k2 p1 p2 [k3]) y' = y q + p1 (r^2 + 2 y^2) + 2 p2 x y
//   (.. k3 k4 k5 k6)   the same with q / (1 + k4 r^2 + k5 r^4 + k6 r^6) in place of q: the rational model
//   (.. s1 s2 s3 s4)   and s1 r^2 + s2 r^4 added to x', s3 r^2 + s4 r^4 to y': a thin prism
//   (.. tau_x tau_y)   and what that makes seen on a sensor that is turned by these angles, radians:
//                      w = P R (x', y', 1),  (x', y') = (w_0, w_1) / w_2,  R = R_y(tau_y) R_x(tau_x),
//                      P = (R_22 0 -R_02, 0 R_22 -R_12, 0 0 1)
//   equidistant        (x', y') = (x, y) theta_d / r,  theta = atan r,
//   (k1 k2 k3 k4)      theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
//
// Source: Brown, Close-range camera calibration (1971); OpenCV's calib3d (the rational model
// with thin prism and tilted sensor: 8, 12 or 14 coefficients); Kannala and
// Brandt, A generic camera model and calibration method (PAMI 2006), the model that Kalibr calls equidistant
// and OpenCV fisheye.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace penumbra::slam {

enum class LensModel { radial_tangential, equidistant };

// A real camera: pixel = K (x', y').
struct LensCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  LensModel model = LensModel::radial_tangential;
  std::vector<double> distortion;  // 4, 5, 8, 12 or 14 coefficients in the order above; none: no distortion
  int width = 0, height = 0;       // pixels
};

// The pixel that shows the direction (x, y, 1).
Eigen::Vector2d pixel_of(const LensCamera& camera, const Eigen::Vector2d& direction);

// The direction that a pixel shows. Radial-tangential: 5 rounds of a fixed-point iteration, which at the
// corners of EuRoC's images (60 degrees from left to right) leave an error of 1e-4; it serves to choose the
// view of the undistorted image, not to measure. Equidistant: Newton's method, not a number where it finds
// nothing before the camera.
Eigen::Vector2d direction_of(const LensCamera& camera, const Eigen::Vector2d& pixel);

}  // namespace penumbra::slam
