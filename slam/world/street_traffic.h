// Everything that moves in a street: oncoming cars, one car or lorry ahead, people and cyclists. All follow
// the drive's route at constant speed, except for the lorry, which keeps its distance from the camera.
// Nothing that would run into the camera or into another car, as at a crossing of the route with itself, is
// let in.
#pragma once

#include <functional>

#include "slam/world/noise.h"
#include "slam/world/street_settings.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

struct TrafficPlan {
  const Drive& drive;
  const StreetSettings& settings;
  int moving_cars = 0;  // how many cars move where settings.moving says their share
  std::function<void(Object&)> give_instance;
};

// The roads must lie already.
void add_traffic(World& world, const TrafficPlan& plan, RandomSequence& random);

}  // namespace penumbra::slam::synthetic
