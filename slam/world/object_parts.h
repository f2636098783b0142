// What the makers of objects share.
#pragma once

#include "slam/world/noise.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

inline Body with_material(Body body, int material) {
  body.material = material;
  return body;
}

inline int plain_material(World& world, RandomSequence& random, const Colour& colour,
                          Surface surface = Surface::matte) {
  Material material;
  material.surface = surface;
  material.colour = colour;
  material.seed = random.bits();
  return add_material(world, material);
}

// Moves `body` to the right.
inline Body shifted(Body body, float right) {
  for (int i = 0; i < body.plane_count; ++i) {
    Plane& plane = body.planes[static_cast<std::size_t>(i)];
    plane.offset -= plane.normal.x() * right;
  }
  body.centre.x() += right;
  body.lower.x() += right;
  body.upper.x() += right;
  return body;
}

}  // namespace penumbra::slam::synthetic
