// Convex bodies, the only shape of the synthetic world: an ellipsoid or cylinder (or all of space) cut by
// half-spaces. A ray meets a convex body in one interval of depth, found from each part's own interval:
//
//   half-space n . p + d <= 0:   entered or left at  t = -(n . o + d) / (n . r)
//   quadric |W (p - c)|^2 <= 1:  a t^2 + 2 b t + k = 0  with  e = W r,  f = W (o - c),
//                                a = e . e,  b = e . f,  k = f . f - 1;   W = diag(1/radius), 0 = endless
//                                axis
//
// Coordinates are those of the object that the body belongs to: x right, y down, z forward, metres; y = 0 is
// the ground.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace penumbra::slam::synthetic {

struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit length, points out of the body
  float offset = 0.0F;                               // inside: normal . p + offset <= 0
};

struct Body {
  static constexpr int kMaxPlanes = 12;

  std::array<Plane, kMaxPlanes> planes;
  int plane_count = 0;
  bool round = false;  // has a quadric
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  Eigen::Vector3f inverse_radii = Eigen::Vector3f::Zero();  // 1/metres; 0 along the axis of a cylinder
  Eigen::Vector3f lower = Eigen::Vector3f::Zero();          // bounding box
  Eigen::Vector3f upper = Eigen::Vector3f::Zero();
  int material = 0;           // index in World::materials
  bool casts_shadow = false;  // onto the ground
  bool ragged = false;        // leaves: the surface has holes, more of them towards the silhouette
};

// The factories leave material and flags to the caller.
Body make_box(const Eigen::Vector3f& lower, const Eigen::Vector3f& upper);
Body make_ellipsoid(const Eigen::Vector3f& centre, const Eigen::Vector3f& radii);
// A cylinder along axis 0, 1 or 2 (x, y, z), `length` long, with its middle at `centre`.
Body make_cylinder(const Eigen::Vector3f& centre, int axis, float radius, float length);
// A convex outline in the (z, y) plane, given in order (either way round), swept along x over +-half_width
// at y = `wide_y`; the sides lean inwards by `lean` metres per metre of height above it (0 = upright).
// At most kMaxPlanes - 2 corners.
Body make_swept(const std::vector<Eigen::Vector2f>& outline_zy, float half_width, float lean = 0.0F,
                float wide_y = 0.0F);

// Cuts `body` by a further half-space through `point`; the caller keeps plane_count below kMaxPlanes.
void cut(Body& body, const Eigen::Vector3f& point, const Eigen::Vector3f& outward);

// Length of the part of the ray origin + t direction, t > 0, inside the body, in units of t; 0 where it
// misses.
float chord(const Body& body, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction);

}  // namespace penumbra::slam::synthetic
