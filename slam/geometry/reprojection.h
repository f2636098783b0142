// Reprojection errors and their derivatives: what pose estimation and bundle adjustment minimise.
//
//   p = T_cw X = R X + t                                        point in the camera's frame
//   e = pi(p) - z,   pi(p) = (fx x/z + cx, fy y/z + cy, fx (x - b)/z + cx - d0)      pixels;
//                                                                            the third row for stereo
//
//   J_pi   = de/dp = [ fx/z  0  -fx x/z^2 ;  0  fy/z  -fy y/z^2 ;  fx/z  0  -fx (x - b)/z^2 ]
//   J_pose = de/dxi  = J_pi [ I | -[p]x ]       for T_cw <- exp(xi) T_cw, xi = (rho, phi)
//   J_point = de/dX  = J_pi R,      de/dd0 = (0, 0, -1) for stereo
//
// Huber: rho(s) = s for s <= d^2, else 2 d sqrt(s) - d^2, of the squared weighted error s; weight rho'(s).
// Gates: chi_square.h, with 2 and 3 degrees of freedom.
// Source: Barfoot (2017) section 7.3; Mur-Artal, Tardos, ORB-SLAM2, section III-B (stereo residual).
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "slam/geometry/chi_square.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// A measured pixel: (u, v, u_right), u_right only where `stereo`.
struct PixelMeasurement {
  Eigen::Vector3d pixel = Eigen::Vector3d::Zero();
  double inverse_variance = 1.0;  // 1 / sigma^2, 1/pixels^2; of a feature: measurement.h
  bool stereo = false;

  double gate() const { return stereo ? kChiSquare3 : kChiSquare2; }
};

// e for point `p` in the camera's frame, p.z() > 0; the third row is 0 for monocular measurements.
inline Eigen::Vector3d reprojection_error(const StereoCamera& camera, const Eigen::Vector3d& p,
                                          const PixelMeasurement& z) {
  Eigen::Vector3d e = camera.project_stereo(p) - z.pixel;
  if (!z.stereo) e.z() = 0.0;
  return e;
}

// |e|^2 / sigma^2 of a point `p` in the camera's frame, before the camera.
inline double weighted_error(const StereoCamera& camera, const Eigen::Vector3d& p,
                             const PixelMeasurement& z) {
  return reprojection_error(camera, p, z).squaredNorm() * z.inverse_variance;
}

// Whether a point agrees with a measurement: before the camera, and within its chi-square gate.
inline bool within_gate(const StereoCamera& camera, const Eigen::Vector3d& p, const PixelMeasurement& z) {
  return p.z() > 0.0 && weighted_error(camera, p, z) <= z.gate();
}

// J_pi; the third row is 0 for monocular measurements.
inline Eigen::Matrix3d projection_jacobian(const StereoCamera& camera, const Eigen::Vector3d& p,
                                           bool stereo) {
  const double iz = 1.0 / p.z(), iz2 = iz * iz;
  Eigen::Matrix3d J;
  J << camera.fx * iz, 0.0, -camera.fx * p.x() * iz2,  //
      0.0, camera.fy * iz, -camera.fy * p.y() * iz2,   //
      camera.fx * iz, 0.0, -camera.fx * (p.x() - camera.baseline) * iz2;
  if (!stereo) J.row(2).setZero();
  return J;
}

// J_pose from J_pi.
inline Eigen::Matrix<double, 3, 6> pose_jacobian(const Eigen::Matrix3d& J_pi, const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = J_pi;
  // -J_pi [p]x: row by row the cross product p x row.
  for (int r = 0; r < 3; ++r) J.block<1, 3>(r, 3) = p.cross(J_pi.row(r).transpose()).transpose();
  return J;
}

struct Huber {
  double cost = 0.0;    // rho(s)
  double weight = 1.0;  // rho'(s)
};

// `s`: squared weighted error; `delta_squared`: d^2, infinite for plain least squares.
inline Huber huber(double s, double delta_squared) {
  if (s <= delta_squared) return {s, 1.0};
  const double delta = std::sqrt(delta_squared), e = std::sqrt(s);
  return {2.0 * delta * e - delta_squared, delta / e};
}

}  // namespace penumbra::slam
