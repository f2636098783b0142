// Builds a street around a drive: the road follows the camera's track, houses line it and never cut it, also
// where the drive meets or repeats itself; parked cars, trees, lamps, signs and people fill the space
// between. Everything follows from the seed; a place looks the same whenever the drive returns to it, apart
// from what moves.
#pragma once

#include "slam/world/street_settings.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

// Throws UsageError where the drive needs more instances than 16-bit ids can name.
World build_street(const Drive& drive, const StreetSettings& settings, std::uint32_t seed);

}  // namespace penumbra::slam::synthetic
