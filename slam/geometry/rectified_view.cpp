#include "slam/geometry/rectified_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace penumbra::slam {

namespace {

// As a float holds it. g++ 12 leaves the rounding out where it makes one vector of two such conversions, to
// float and back: hence the volatile.
double in_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return rounded;
}
Eigen::Vector2d in_float(const Eigen::Vector2d& p) { return {in_float(p.x()), in_float(p.y())}; }

Eigen::Vector2d projected(const Eigen::Matrix3d& P, const Eigen::Vector2d& direction) {
  const Eigen::Vector3d p = P * direction.homogeneous();
  const double inverse = 1.0 / p.z();
  return {p.x() * inverse, p.y() * inverse};
}

// The largest upright rectangle that no border of the real image enters, of the points that P makes.
struct InnerRectangle {
  float left = std::numeric_limits<float>::lowest(), right = std::numeric_limits<float>::max();
  float top = std::numeric_limits<float>::lowest(), bottom = std::numeric_limits<float>::max();

  InnerRectangle(const LensCamera& lens, const Eigen::Matrix3d& P) {
    constexpr int kLast = 8;
    for (int j = 0; j <= kLast; ++j) {
      for (int i = 0; i <= kLast; ++i) {
        const Eigen::Vector2d pixel(in_float(static_cast<double>(i) * lens.width / kLast),
                                    in_float(static_cast<double>(j) * lens.height / kLast));
        const Eigen::Vector2f p = projected(P, direction_of(lens, pixel)).cast<float>();
        if (i == 0) left = std::max(left, p.x());
        if (i == kLast) right = std::min(right, p.x());
        if (j == 0) top = std::max(top, p.y());
        if (j == kLast) bottom = std::min(bottom, p.y());
      }
    }
  }
  float width() const { return right - left; }
  float height() const { return bottom - top; }
};

// Where the corners' images have their middle, seen from a camera of focal length f and principal point 0.
Eigen::Vector2d middle_of_corners(const LensCamera& lens, const Eigen::Matrix3d& turn, double f) {
  const Eigen::Matrix3d P = Eigen::Vector3d(f, f, 1.0).asDiagonal() * turn;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const double y : {0.0, lens.height - 1.0}) {
    for (const double x : {0.0, lens.width - 1.0}) {
      sum += in_float(projected(P, in_float(direction_of(lens, {x, y}))));
    }
  }
  return sum / 4.0;
}

// The camera, turned, that shows the middles of the four sides.
Pinhole equidistant_view(const LensCamera& lens, const Eigen::Matrix3d& turn) {
  const int w = lens.width, h = lens.height;
  const double aspect = lens.fx / lens.fy;
  std::array<Eigen::Vector2d, 4> sides;
  const Eigen::Vector2d pixels[] = {{w / 2, 0.0}, {w, h / 2}, {w / 2, h}, {0.0, h / 2}};
  Eigen::Vector2d middle = Eigen::Vector2d::Zero(), low = Eigen::Vector2d::Constant(1e300), high = -low;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    sides[i] = projected(turn, direction_of(lens, pixels[i]));
    middle += sides[i] / 4.0;
  }
  // With pixels that are as high as they are wide.
  middle.y() *= aspect;
  for (Eigen::Vector2d& side : sides) {
    side.y() *= aspect;
    low = low.cwiseMin(side);
    high = high.cwiseMax(side);
  }
  const double f =
      std::max({0.5 * w / (middle.x() - low.x()), 0.5 * w / (high.x() - middle.x()),
                0.5 * h * aspect / (middle.y() - low.y()), 0.5 * h * aspect / (high.y() - middle.y())});
  return {f, f / aspect, 0.5 * w - middle.x() * f, (0.5 * h * aspect - middle.y() * f) / aspect};
}

}  // namespace

RectifyingTurns rectifying_turns(const SE3& T_right_left) {
  const Eigen::Matrix3d half = so3_exp(-0.5 * so3_log(T_right_left.rotation));
  const Eigen::Vector3d t = half * T_right_left.translation;
  const Eigen::Vector3d e(t.x() > 0.0 ? 1.0 : -1.0, 0.0, 0.0);
  Eigen::Vector3d axis = t.cross(e);
  if (axis.norm() > 0.0) axis *= std::acos(std::abs(t.x()) / t.norm()) / axis.norm();
  const Eigen::Matrix3d level = so3_exp(axis);
  return {level * half.transpose(), level * half};
}

Pinhole rectified_view(const LensCamera& lens) {
  if (lens.model == LensModel::equidistant) return equidistant_view(lens, Eigen::Matrix3d::Identity());
  const InnerRectangle inner(lens, Eigen::Matrix3d::Identity());
  const auto fx = static_cast<double>(static_cast<float>(lens.width - 1) / inner.width());
  const auto fy = static_cast<double>(static_cast<float>(lens.height - 1) / inner.height());
  return {fx, fy, -fx * inner.left, -fy * inner.top};
}

Pinhole rectified_view(const LensCamera& left, const LensCamera& right, const RectifyingTurns& turns) {
  if (left.model == LensModel::equidistant) {
    const Pinhole a = equidistant_view(left, turns.left), b = equidistant_view(right, turns.right);
    const double f = std::min(a.fy, b.fy);
    return {f, f, 0.5 * (a.cx + b.cx), 0.5 * (a.cy + b.cy)};
  }
  const double f = 0.5 * (left.fy + right.fy);
  const Eigen::Vector2d in_left = middle_of_corners(left, turns.left, f);
  const Eigen::Vector2d in_right = middle_of_corners(right, turns.right, f);
  const Eigen::Vector2d last(left.width - 1.0, left.height - 1.0);
  const Eigen::Vector2d c = 0.5 * ((0.5 * last - in_left) + (0.5 * last - in_right));
  const Pinhole view{f, f, c.x(), c.y()};
  double scale = -std::numeric_limits<double>::infinity();
  for (const auto& [lens, turn] : {std::pair(&left, &turns.left), {&right, &turns.right}}) {
    const InnerRectangle inner(*lens, view.matrix() * *turn);
    const float end_x = inner.left + inner.width(), end_y = inner.top + inner.height();
    scale = std::max({scale, c.x() / (c.x() - inner.left), c.y() / (c.y() - inner.top),
                      (left.width - c.x()) / (end_x - c.x()), (left.height - c.y()) / (end_y - c.y())});
  }
  return {scale * f, scale * f, c.x(), c.y()};
}

}  // namespace penumbra::slam
