// The point that two or more rays see.
//
// Linear triangulation: with T_cw = [R | t] and the normalised pixel (x, y) = ((u - cx)/fx, (v - cy)/fy)
// every view gives two rows   x (r3 X + t3) - (r1 X + t1) = 0,   y (r3 X + t3) - (r2 X + t2) = 0; their
// least-squares solution in X. Source: Hartley, Zisserman, Multiple View Geometry (2004), section 12.2.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <span>

#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

struct View {
  SE3 T_cw;
  Eigen::Vector2d pixel;
};

// Point in the world; nothing where the rays are parallel or the point is behind a camera.
std::optional<Eigen::Vector3d> triangulate(const StereoCamera& camera, std::span<const View> views);

// Cosine of the angle between the rays of two views, 1 where they are parallel.
double ray_cosine(const StereoCamera& camera, const View& a, const View& b);

// F with x_b^T F x_a = 0 for pixels (homogeneous) of views a and b of one camera; Hartley, Zisserman (9.2).
Eigen::Matrix3d fundamental_matrix(const StereoCamera& camera, const SE3& T_aw, const SE3& T_bw);

// The epipolar line of pixel `a`, on which the other view shows the same point.
class EpipolarLine {
 public:
  EpipolarLine(const Eigen::Matrix3d& F, const Eigen::Vector2d& a)
      : line_(F * a.homogeneous()), squared_norm_(line_.head<2>().squaredNorm()) {}

  // a, b, c with a u + b v + c = 0
  const Eigen::Vector3d& coefficients() const { return line_; }
  // Of pixel `b` from the line, pixels^2; infinite where there is no line.
  double squared_distance(const Eigen::Vector2d& b) const {
    if (squared_norm_ == 0.0) return std::numeric_limits<double>::infinity();
    const double residual = line_.dot(b.homogeneous());
    return residual * residual / squared_norm_;
  }

 private:
  Eigen::Vector3d line_;
  double squared_norm_;
};

// Squared distance (pixels^2) of pixel `b` from the epipolar line of pixel `a`.
inline double squared_epipolar_distance(const Eigen::Matrix3d& F, const Eigen::Vector2d& a,
                                        const Eigen::Vector2d& b) {
  return EpipolarLine(F, a).squared_distance(b);
}

}  // namespace penumbra::slam
