// What the builders of an office's things share.
#pragma once

#include "slam/world/object_parts.h"

namespace penumbra::slam::synthetic {

inline int office_material(World& world, RandomSequence& random, Surface surface, const Colour& colour,
                           const Colour& accent = Colour::Constant(0.5F)) {
  Material material;
  material.surface = surface;
  material.colour = colour;
  material.accent = accent;
  material.seed = random.bits();
  return add_material(world, material);
}

inline Colour pick_tint(RandomSequence& random) {
  static const Colour kPaints[] = {{0.55F, 0.12F, 0.08F}, {0.10F, 0.20F, 0.45F}, {0.62F, 0.55F, 0.20F},
                                   {0.12F, 0.36F, 0.22F}, {0.70F, 0.70F, 0.68F}, {0.08F, 0.08F, 0.09F},
                                   {0.45F, 0.25F, 0.50F}, {0.70F, 0.38F, 0.12F}};
  const Colour picked = kPaints[random.below(static_cast<int>(std::size(kPaints)))];
  return picked * random.uniform(0.7F, 1.1F);
}

// A material of two random paints.
inline int two_paints(World& world, RandomSequence& random, Surface surface) {
  const Colour first = pick_tint(random), second = pick_tint(random);
  return office_material(world, random, surface, first, second);
}

// A box by its middle on the ground plane, its lower and upper heights and its half sizes.
inline Body block(float x, float z, float half_x, float half_z, float low, float high, int material) {
  return with_material(make_box({x - half_x, -high, z - half_z}, {x + half_x, -low, z + half_z}), material);
}

inline Object& add_classed(World& world, const std::vector<Body>& bodies, ObjectClass object_class) {
  Object& object = add_object(world, bodies);
  object.object_class = object_class;
  return object;
}

}  // namespace penumbra::slam::synthetic
