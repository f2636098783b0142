// Builds a street around a drive: the road follows the camera's track, houses line it and never cut it, also
// where the drive meets or repeats itself; parked cars, trees, lamps, signs and people fill the space
// between. Everything follows from the seed; a place looks the same whenever the drive returns to it, apart
// from what moves.
#pragma once

#include <string>

#include "slam/datasets/synthetic/world.h"

namespace penumbra::slam::synthetic {

struct StreetSettings {
  float parked_cars = 0.6F;        // share of the parking places that are taken
  float oncoming_seconds = 6.0F;   // between two oncoming cars
  float people_per_100m = 2.0F;    // walking on the pavements
  float cyclists_per_100m = 1.0F;  // riding between lane and parked cars
  float lorries = 0.08F;           // share of lorries among parked and oncoming cars
  bool car_ahead = true;           // a car drives ahead of the camera and slowly away from it
};

// "easy", "street" or "crowded"; throws UsageError for another name.
StreetSettings street_preset(const std::string& name);

// Throws UsageError where the drive needs more instances than 16-bit ids can name.
World build_street(const Drive& drive, const StreetSettings& settings, std::uint32_t seed);

}  // namespace penumbra::slam::synthetic
