// A rectified stereo pair of pinhole cameras: both look along +z, x to the right, y down; rows correspond.
//
//   u = fx X/Z + cx,   v = fy Y/Z + cy,   u_right = u - fx b / Z - d0       pixels; X, Y, Z, b in metres
//   disparity d = u - u_right = fx b / Z + d0
//
// d0, the disparity of a point at infinity, is 0 in a pair that is rectified exactly. A right camera that is
// turned about its y axis by 0.01 degrees from where the calibration puts it makes 0.1 pixels of it at fx =
// 700, and with it a depth of 30 m wrong by 0.8 %. Bundle adjustment finds it
// (slam/backend/bundle_equations.h).
//
// Pixel (0, 0) is the centre of the upper left pixel. KITTI: P0 = K [I | 0], P1 = K [I | (-b, 0, 0)].
#pragma once

#include <Eigen/Core>

namespace penumbra::slam {

struct StereoCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  double baseline = 0.0;                          // metres
  int width = 0, height = 0;                      // pixels
  double disparity_offset = 0.0;                  // d0, pixels

  // Point in the left camera's frame (Z > 0) to its pixel.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  // The same with the right image's column: (u, v, u_right).
  Eigen::Vector3d project_stereo(const Eigen::Vector3d& p) const {
    const double u = fx * p.x() / p.z() + cx;
    return {u, fy * p.y() / p.z() + cy, u - fx * baseline / p.z() - disparity_offset};
  }
  // Pixel and depth (metres) to the point in the left camera's frame.
  Eigen::Vector3d back_project(double u, double v, double depth) const {
    return {(u - cx) / fx * depth, (v - cy) / fy * depth, depth};
  }
  // `disparity` > disparity_offset.
  double depth_from_disparity(double disparity) const {
    return fx * baseline / (disparity - disparity_offset);
  }
  bool in_image(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width - 1.0 && pixel.y() <= height - 1.0;
  }
};

}  // namespace penumbra::slam
