#include "slam/geometry/p3p.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

namespace penumbra::slam {

namespace {

// Orthonormal frame of a triangle, as columns: along P1 P2, in the plane, normal.
Eigen::Matrix3d triangle_frame(const std::array<Eigen::Vector3d, 3>& p) {
  Eigen::Matrix3d frame;
  const Eigen::Vector3d x = (p[1] - p[0]).normalized();
  const Eigen::Vector3d z = x.cross(p[2] - p[0]).normalized();
  frame << x, z.cross(x), z;
  return frame;
}

// The motion that takes triangle `world` to the congruent triangle `camera`.
SE3 align_triangles(const std::array<Eigen::Vector3d, 3>& world,
                    const std::array<Eigen::Vector3d, 3>& camera) {
  SE3 T_cw;
  T_cw.rotation = triangle_frame(camera) * triangle_frame(world).transpose();
  const Eigen::Vector3d world_centre = (world[0] + world[1] + world[2]) / 3.0;
  const Eigen::Vector3d camera_centre = (camera[0] + camera[1] + camera[2]) / 3.0;
  T_cw.translation = camera_centre - T_cw.rotation * world_centre;
  return T_cw;
}

}  // namespace

ShortList<double, 4> real_roots(const std::array<double, 5>& coefficients) {
  double largest = 0.0;
  for (const double c : coefficients) largest = std::max(largest, std::abs(c));
  if (!std::isfinite(largest) || largest == 0.0) return {};
  int degree = 4;
  const auto c = [&](int i) { return coefficients[static_cast<std::size_t>(i)]; };
  while (degree > 0 && std::abs(c(degree)) < 1e-14 * largest) --degree;
  if (degree < 1) return {};

  // The roots are the eigenvalues of the companion matrix, which lies on the stack.
  using Companion = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 4, 4>;
  Companion companion = Companion::Zero(degree, degree);
  for (int i = 0; i < degree; ++i) {
    companion(i, degree - 1) = -c(i) / c(degree);
    if (i > 0) companion(i, i - 1) = 1.0;
  }
  const Eigen::EigenSolver<Companion> eigen(companion, false);
  if (eigen.info() != Eigen::Success) return {};
  ShortList<double, 4> roots;
  for (int i = 0; i < degree; ++i) {
    const std::complex<double> z = eigen.eigenvalues()[i];
    // A double root comes out as a pair whose imaginary part is about the square root of the rounding error.
    if (std::abs(z.imag()) > 1e-5 * (1.0 + std::abs(z.real()))) continue;
    double x = z.real();
    for (int iteration = 0; iteration < 3; ++iteration) {
      double value = 0.0, slope = 0.0;
      for (int k = degree; k >= 0; --k) {
        slope = slope * x + value;
        value = value * x + c(k);
      }
      const double step = slope != 0.0 ? value / slope : 0.0;
      if (!std::isfinite(step) || std::abs(step) > 0.1 * (1.0 + std::abs(x))) break;
      x -= step;
    }
    roots.push_back(x);
  }
  return roots;
}

ShortList<SE3, 4> solve_p3p(const std::array<Eigen::Vector3d, 3>& points,
                            const std::array<Eigen::Vector3d, 3>& rays) {
  const double a2 = (points[1] - points[2]).squaredNorm(), b2 = (points[0] - points[2]).squaredNorm(),
               c2 = (points[0] - points[1]).squaredNorm();
  const double area = (points[1] - points[0]).cross(points[2] - points[0]).norm();
  if (!(area > 1e-9 * std::max({a2, b2, c2}))) return {};
  const double cos_a = rays[1].dot(rays[2]), cos_b = rays[0].dot(rays[2]), cos_c = rays[0].dot(rays[1]);
  if (std::max({cos_a, cos_b, cos_c}) > 1.0 - 1e-12) return {};

  const double m = (a2 - c2) / b2, p = (a2 + c2) / b2, cb = c2 / b2, ab = a2 / b2;
  const std::array<double, 5> quartic = {
      (1.0 + m) * (1.0 + m) - 4.0 * ab * cos_c * cos_c,
      4.0 * (-m * (1.0 + m) * cos_b + 2.0 * ab * cos_c * cos_c * cos_b - (1.0 - p) * cos_a * cos_c),
      2.0 * (m * m - 1.0 + 2.0 * m * m * cos_b * cos_b + 2.0 * (1.0 - cb) * cos_a * cos_a -
             4.0 * p * cos_a * cos_b * cos_c + 2.0 * (1.0 - ab) * cos_c * cos_c),
      4.0 * (m * (1.0 - m) * cos_b - (1.0 - p) * cos_a * cos_c + 2.0 * cb * cos_a * cos_a * cos_b),
      (m - 1.0) * (m - 1.0) - 4.0 * cb * cos_a * cos_a};

  ShortList<SE3, 4> poses;
  for (const double v : real_roots(quartic)) {
    const double denominator = 2.0 * (cos_c - v * cos_a);
    if (v <= 0.0 || std::abs(denominator) < 1e-12) continue;
    const double u = ((m - 1.0) * v * v - 2.0 * m * cos_b * v + 1.0 + m) / denominator;
    const double s1_squared = b2 / (1.0 + v * v - 2.0 * v * cos_b);
    if (u <= 0.0 || !(s1_squared > 0.0)) continue;
    const double s1 = std::sqrt(s1_squared);
    const SE3 T_cw = align_triangles(points, {s1 * rays[0], u * s1 * rays[1], v * s1 * rays[2]});
    if (T_cw.is_finite()) poses.push_back(T_cw);
  }
  return poses;
}

}  // namespace penumbra::slam
