#include "slam/geometry/lens.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra::slam {

namespace {

double coefficient(const LensCamera& camera, std::size_t i) {
  return i < camera.distortion.size() ? camera.distortion[i] : 0.0;
}

// What a sensor that is turned sees of the place that the lens shows to an upright one.
Eigen::Matrix3d tilt_of(double tau_x, double tau_y) {
  const double cx = std::cos(tau_x), sx = std::sin(tau_x), cy = std::cos(tau_y), sy = std::sin(tau_y);
  Eigen::Matrix3d about_x, about_y, project;
  about_x << 1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx;
  about_y << cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy;
  const Eigen::Matrix3d R = about_y * about_x;
  project << R(2, 2), 0.0, -R(0, 2), 0.0, R(2, 2), -R(1, 2), 0.0, 0.0, 1.0;
  return project * R;
}

struct RadialTangential {
  double k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4;
  bool is_tilted;
  Eigen::Matrix3d tilt = Eigen::Matrix3d::Identity();
  explicit RadialTangential(const LensCamera& c)
      : k1(coefficient(c, 0)),
        k2(coefficient(c, 1)),
        p1(coefficient(c, 2)),
        p2(coefficient(c, 3)),
        k3(coefficient(c, 4)),
        k4(coefficient(c, 5)),
        k5(coefficient(c, 6)),
        k6(coefficient(c, 7)),
        s1(coefficient(c, 8)),
        s2(coefficient(c, 9)),
        s3(coefficient(c, 10)),
        s4(coefficient(c, 11)),
        is_tilted(coefficient(c, 12) != 0.0 || coefficient(c, 13) != 0.0) {
    if (is_tilted) tilt = tilt_of(coefficient(c, 12), coefficient(c, 13));
  }
  double radial(double r2) const {
    return (1.0 + ((k3 * r2 + k2) * r2 + k1) * r2) / (1.0 + ((k6 * r2 + k5) * r2 + k4) * r2);
  }
  // What the lens's elements that stand askew add.
  Eigen::Vector2d tangential(const Eigen::Vector2d& d) const {
    const double r2 = d.squaredNorm(), xy2 = 2.0 * d.x() * d.y();
    return {p1 * xy2 + p2 * (r2 + 2.0 * d.x() * d.x()) + (s2 * r2 + s1) * r2,
            p1 * (r2 + 2.0 * d.y() * d.y()) + p2 * xy2 + (s4 * r2 + s3) * r2};
  }
  Eigen::Vector2d on_sensor(const Eigen::Vector2d& seen) const {
    return is_tilted ? (tilt * seen.homogeneous()).hnormalized() : seen;
  }
  Eigen::Vector2d before_sensor(const Eigen::Vector2d& seen) const {
    return is_tilted ? (tilt.inverse() * seen.homogeneous()).hnormalized() : seen;
  }
};

struct Equidistant {
  double k1, k2, k3, k4;
  explicit Equidistant(const LensCamera& c)
      : k1(coefficient(c, 0)), k2(coefficient(c, 1)), k3(coefficient(c, 2)), k4(coefficient(c, 3)) {}
  double theta_d(double theta) const {
    const double t2 = theta * theta;
    return theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
  }
  double slope(double theta) const {
    const double t2 = theta * theta;
    return 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)));
  }
};

Eigen::Vector2d undistort_radial_tangential(const RadialTangential& model, const Eigen::Vector2d& on_sensor) {
  constexpr int kRounds = 5;
  const Eigen::Vector2d seen = model.before_sensor(on_sensor);
  Eigen::Vector2d d = seen;
  for (int i = 0; i < kRounds; ++i) {
    const double inverse = 1.0 / model.radial(d.squaredNorm());
    if (inverse < 0.0) return seen;  // beyond where the model says anything
    d = (seen - model.tangential(d)) * inverse;
  }
  return d;
}

Eigen::Vector2d undistort_equidistant(const Equidistant& model, const Eigen::Vector2d& seen) {
  constexpr int kRounds = 20;
  constexpr double kSmallest = 1e-8, kRightAngle = std::numbers::pi / 2.0;
  const double wanted = std::min(seen.norm(), kRightAngle);
  if (wanted <= kSmallest) return seen;
  double theta = wanted;
  for (int i = 0; i < kRounds; ++i) {
    const double step = (model.theta_d(theta) - wanted) / model.slope(theta);
    theta -= step;
    if (std::abs(step) >= kSmallest) continue;
    if (theta > 0.0 && theta < kRightAngle) return seen * (std::tan(theta) / wanted);
    break;
  }
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

Eigen::Vector2d pixel_of(const LensCamera& camera, const Eigen::Vector2d& direction) {
  Eigen::Vector2d seen;
  if (camera.model == LensModel::equidistant) {
    const double r = direction.norm();
    seen =
        r == 0.0 ? direction : Eigen::Vector2d(direction * (Equidistant(camera).theta_d(std::atan(r)) / r));
  } else {
    const RadialTangential model(camera);
    seen = model.on_sensor(direction * model.radial(direction.squaredNorm()) + model.tangential(direction));
  }
  return {camera.fx * seen.x() + camera.cx, camera.fy * seen.y() + camera.cy};
}

Eigen::Vector2d direction_of(const LensCamera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d seen((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  if (camera.model == LensModel::equidistant) return undistort_equidistant(Equidistant(camera), seen);
  return undistort_radial_tangential(RadialTangential(camera), seen);
}

}  // namespace penumbra::slam
