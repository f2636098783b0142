#include "slam/geometry/lens.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra::slam {

namespace {

double coefficient(const LensCamera& camera, std::size_t i) {
  return i < camera.distortion.size() ? camera.distortion[i] : 0.0;
}

struct RadialTangential {
  double k1, k2, p1, p2, k3, k4, k5, k6;
  explicit RadialTangential(const LensCamera& c)
      : k1(coefficient(c, 0)),
        k2(coefficient(c, 1)),
        p1(coefficient(c, 2)),
        p2(coefficient(c, 3)),
        k3(coefficient(c, 4)),
        k4(coefficient(c, 5)),
        k5(coefficient(c, 6)),
        k6(coefficient(c, 7)) {}
  double radial(double r2) const {
    return (1.0 + ((k3 * r2 + k2) * r2 + k1) * r2) / (1.0 + ((k6 * r2 + k5) * r2 + k4) * r2);
  }
  Eigen::Vector2d tangential(const Eigen::Vector2d& d) const {
    const double r2 = d.squaredNorm(), xy2 = 2.0 * d.x() * d.y();
    return {p1 * xy2 + p2 * (r2 + 2.0 * d.x() * d.x()), p1 * (r2 + 2.0 * d.y() * d.y()) + p2 * xy2};
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

Eigen::Vector2d undistort_radial_tangential(const RadialTangential& model, const Eigen::Vector2d& seen) {
  constexpr int kRounds = 5;
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
    seen = direction * model.radial(direction.squaredNorm()) + model.tangential(direction);
  }
  return {camera.fx * seen.x() + camera.cx, camera.fy * seen.y() + camera.cy};
}

Eigen::Vector2d direction_of(const LensCamera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d seen((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  if (camera.model == LensModel::equidistant) return undistort_equidistant(Equidistant(camera), seen);
  return undistort_radial_tangential(RadialTangential(camera), seen);
}

}  // namespace penumbra::slam
