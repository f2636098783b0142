// The things that stand in a street, each as one object of a few convex bodies; sizes, shapes and colours
// come from `random`. The caller sets the pose; instance numbers are given by the builder.
#pragma once

#include "slam/world/noise.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

// A car (saloon, hatchback, estate, off-roader) or van looking along +z; vans are of class truck.
Object& add_car(World& world, RandomSequence& random);
// A lorry with a closed box, looking along +z; the second of a given size.
struct LorrySize {
  float length = 7.5F, width = 2.4F, height = 3.6F;  // metres
};
Object& add_lorry(World& world, RandomSequence& random);
Object& add_lorry(World& world, RandomSequence& random, const LorrySize& size);
// A walking person and one on a bicycle, looking along +z.
Object& add_person(World& world, RandomSequence& random);
Object& add_cyclist(World& world, RandomSequence& random);
// A house `width` metres wide (along z) and `depth` deep (along x), with its front towards -x.
Object& add_house(World& world, RandomSequence& random, float width, float depth);
// A trunk with four to six crowns of leaves.
Object& add_tree(World& world, RandomSequence& random);
// A street lamp that reaches towards -x, a bin, a hedge along z.
Object& add_lamp(World& world, RandomSequence& random);
Object& add_bin(World& world, RandomSequence& random);
Object& add_hedge(World& world, RandomSequence& random, float length);
// A traffic sign at `pose` that looks along -z: a post, and the plate as an object of its own, which is
// returned.
Object& add_sign(World& world, RandomSequence& random, const GroundPose& pose);

}  // namespace penumbra::slam::synthetic
