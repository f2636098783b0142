// The people of an office and what they move.
#pragma once

#include <functional>
#include <vector>

#include "slam/world/acting.h"
#include "slam/world/office_settings.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

struct Crew {
  People people = People::walking;
  double seconds = 10.0;
  std::vector<GroundPose> chairs;  // of the two who sit at the desks, in the order left, right
  std::function<std::uint16_t()> next_instance;
};

// Adds two people with the chairs they sit on. Walking: each gets up within the first second and a half, then
// crosses before the camera, goes round the desks, comes towards the camera, stands half outside its view;
// one may push a chair away, one may carry a box.
void add_people(World& world, RandomSequence& random, const Crew& crew);

}  // namespace penumbra::slam::synthetic
