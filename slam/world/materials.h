// What surfaces look like: procedural textures in metres, filtered to the size of a pixel on the surface.
#pragma once

#include "slam/world/noise.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

inline Colour blend(const Colour& a, const Colour& b, float weight) { return a + (b - a) * weight; }

// A place on a surface as a camera pixel sees it.
struct SurfacePoint {
  Eigen::Vector3f position;   // in the object's frame (for the ground: the world's), metres
  Eigen::Vector3f normal;     // in the same frame, unit length, towards the camera
  Eigen::Vector3f footprint;  // extent of the pixel on the surface along each axis of that frame, metres
  float texture = 1.0F;       // World::texture

  // The size of detail that the pixel can show: between the footprint's short and long side, nearer to the
  // short one, since a slanted view is sampled finely along one direction.
  float detail(int axis_a, int axis_b) const {
    const float a = footprint[axis_a], b = footprint[axis_b];
    return std::max(std::min(a, b), 0.4F * std::max(a, b));
  }
};

struct Appearance {
  Colour albedo = Colour::Constant(0.5F);
  float gloss = 0.0F;            // share of the sky's mirror image at vertical view
  Colour glow = Colour::Zero();  // light of its own; indoors only
};

// The two axes in which a surface with that normal is best drawn.
inline void drawing_axes(const Eigen::Vector3f& normal, int& a, int& b) {
  const Eigen::Vector3f n = normal.cwiseAbs();
  if (n.y() >= n.x() && n.y() >= n.z()) {
    a = 0;
    b = 2;
  } else if (n.x() >= n.z()) {
    a = 2;
    b = 1;
  } else {
    a = 0;
    b = 1;
  }
}

// The ground at (x, z): asphalt with markings, patches, cracks and covers, kerbs, slabs, grass.
Appearance ground_appearance(const World& world, const SurfacePoint& point);
// A facade or roof; `body` is the house's box or roof.
Appearance facade_appearance(const Material& material, const Body& body, const SurfacePoint& point);
Appearance roof_appearance(const Material& material, const SurfacePoint& point);
// Cars and everything small.
Appearance car_appearance(const Material& material, const Body& body, int face, const SurfacePoint& point);
Appearance lorry_appearance(const Material& material, const Body& body, const SurfacePoint& point);
Appearance wheel_appearance(const Material& material, const Body& body, int face, const SurfacePoint& point);
Appearance plain_appearance(const Material& material, const SurfacePoint& point);

// Walls, furniture, screens and people of an office.
Appearance office_appearance(const Material& material, const Body& body, int face, const SurfacePoint& point);
// What an office's surface sends towards the camera: `position`, `normal` and `view` (from the camera) in the
// world's frame, unit vectors. `sunlight`, which may be null, is told the share of the sun's light on it.
Colour room_light(const World& world, const Appearance& look, const Eigen::Vector3f& position,
                  const Eigen::Vector3f& normal, const Eigen::Vector3f& view, float* sunlight);

// Light that comes from `direction` (unit, world frame): sky with clouds, hills at the horizon.
Colour sky_light(const World& world, const Eigen::Vector3f& direction, float angular_footprint);

}  // namespace penumbra::slam::synthetic
