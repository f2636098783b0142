// The ground plan of a street: where its roads run and which rectangles things stand on.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/world/route.h"

namespace penumbra::slam::synthetic {

// The roads' centrelines for a drive along `route`: the track moved to the middle of the road, without the
// parts where the drive comes along a road that is there already (in either direction).
std::vector<Route> lay_roads(const Route& route);

// A rectangle on the ground: (x, z) coordinates, metres.
struct Footprint {
  Eigen::Vector2d centre, axis_x, axis_z;  // the axes have unit length
  double half_x = 0.0, half_z = 0.0;

  bool overlaps(const Footprint& other) const;
};

// What stands on +-half_x, +-half_z of an object's own axes at `pose`.
Footprint footprint_of(const GroundPose& pose, double half_x, double half_z);

}  // namespace penumbra::slam::synthetic
