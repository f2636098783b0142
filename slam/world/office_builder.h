// Builds an office of about 7 m by 6 m around a pair of desks, and the people in it; everything follows from
// the seed.
//
//   z = 3   shelves, posters, a desk, plain wall
//           walkers' way
//           ---- partition ----                          x from -3.5 (windows) to 3.5
//           [ desk ][ desk ]     z = 0
//            chair     chair
//           walkers' way         z = -1.4
//           camera               z = -2.3, 1.4 m above the floor
#pragma once

#include "slam/world/office_settings.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

struct OfficePlan {
  double half_x = 3.5, half_z = 3.0, height = 2.8;  // of the room, metres; the middle is the origin
};

World build_office(const OfficePlan& plan, People people, double seconds, std::uint32_t seed);

}  // namespace penumbra::slam::synthetic
