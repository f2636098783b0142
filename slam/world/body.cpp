#include "slam/world/body.h"

#include <cmath>
#include <limits>

#include "nn/base/error.h"

namespace penumbra::slam::synthetic {

namespace {

void add_plane(Body& body, const Eigen::Vector3f& point, const Eigen::Vector3f& outward) {
  if (body.plane_count == Body::kMaxPlanes) throw Error("a body has too many planes");
  const Eigen::Vector3f normal = outward.normalized();
  body.planes[static_cast<std::size_t>(body.plane_count++)] = {normal, -normal.dot(point)};
}

}  // namespace

Body make_box(const Eigen::Vector3f& lower, const Eigen::Vector3f& upper) {
  Body body;
  body.lower = lower;
  body.upper = upper;
  for (int axis = 0; axis < 3; ++axis) {
    add_plane(body, lower, -Eigen::Vector3f::Unit(axis));
    add_plane(body, upper, Eigen::Vector3f::Unit(axis));
  }
  return body;
}

Body make_ellipsoid(const Eigen::Vector3f& centre, const Eigen::Vector3f& radii) {
  Body body;
  body.round = true;
  body.centre = centre;
  body.inverse_radii = radii.cwiseInverse();
  body.lower = centre - radii;
  body.upper = centre + radii;
  return body;
}

Body make_cylinder(const Eigen::Vector3f& centre, int axis, float radius, float length) {
  Eigen::Vector3f extent = Eigen::Vector3f::Constant(radius);
  extent[axis] = 0.5F * length;
  Body body = make_ellipsoid(centre, extent);
  body.inverse_radii[axis] = 0.0F;
  add_plane(body, body.lower, -Eigen::Vector3f::Unit(axis));
  add_plane(body, body.upper, Eigen::Vector3f::Unit(axis));
  return body;
}

Body make_swept(const std::vector<Eigen::Vector2f>& outline_zy, float half_width, float lean, float wide_y) {
  Body body;
  Eigen::Vector2f lower = outline_zy.front(), upper = lower, middle = Eigen::Vector2f::Zero();
  for (const Eigen::Vector2f& corner : outline_zy) {
    lower = lower.cwiseMin(corner);
    upper = upper.cwiseMax(corner);
    middle += corner / static_cast<float>(outline_zy.size());
  }
  for (std::size_t i = 0; i < outline_zy.size(); ++i) {
    const Eigen::Vector2f& from = outline_zy[i];
    const Eigen::Vector2f edge = outline_zy[(i + 1) % outline_zy.size()] - from;
    Eigen::Vector2f outward(edge.y(), -edge.x());
    if (outward.dot(middle - from) > 0.0F) outward = -outward;
    add_plane(body, {0.0F, from.y(), from.x()}, {0.0F, outward.y(), outward.x()});
  }
  const Eigen::Vector3f right(half_width, wide_y, 0.0F), left(-half_width, wide_y, 0.0F);
  add_plane(body, right, {1.0F, -lean, 0.0F});
  add_plane(body, left, {-1.0F, -lean, 0.0F});
  const float widest = half_width + lean * std::max(0.0F, upper.y() - wide_y);
  body.lower = {-widest, lower.y(), lower.x()};
  body.upper = {widest, upper.y(), upper.x()};
  return body;
}

void cut(Body& body, const Eigen::Vector3f& point, const Eigen::Vector3f& outward) {
  add_plane(body, point, outward);
}

float chord(const Body& body, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  float enter = 0.0F, leave = std::numeric_limits<float>::infinity();
  if (body.round) {
    const Eigen::Vector3f e = body.inverse_radii.cwiseProduct(direction);
    const Eigen::Vector3f f = body.inverse_radii.cwiseProduct(origin - body.centre);
    const float a = e.dot(e), b = e.dot(f), k = f.dot(f) - 1.0F;
    const float discriminant = b * b - a * k;
    if (discriminant <= 0.0F || a <= 0.0F) return 0.0F;
    const float root = std::sqrt(discriminant);
    enter = std::max(enter, (-b - root) / a);
    leave = (-b + root) / a;
  }
  for (int i = 0; i < body.plane_count; ++i) {
    const Plane& plane = body.planes[static_cast<std::size_t>(i)];
    const float value = plane.normal.dot(origin) + plane.offset, slope = plane.normal.dot(direction);
    if (slope < 0.0F) {
      enter = std::max(enter, -value / slope);
    } else if (slope > 0.0F) {
      leave = std::min(leave, -value / slope);
    } else if (value > 0.0F) {
      return 0.0F;
    }
    if (enter >= leave) return 0.0F;
  }
  return std::max(0.0F, leave - enter);
}

}  // namespace penumbra::slam::synthetic
