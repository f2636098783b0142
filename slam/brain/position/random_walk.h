// A rat's walk through a room: constant speed, a turn rate that wanders, a new direction at a wall.
//
//   w <- a w + s sqrt(1 - a^2) z,   a = exp(-dt / tau),   h <- h + w dt,   x <- x + v dt (cos h, sin h)
//
// z is normal: an Ornstein-Uhlenbeck process. A step that would leave the room is tried again with a random
// heading, and the turn rate starts at 0.
//
// Cost: 0.1 us a step.
// Source: Uhlenbeck and Ornstein, On the theory of the Brownian motion (1930).
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "slam/brain/position/random_stream.h"
#include "slam/brain/position/room.h"

namespace penumbra::slam::brain {

struct WalkSettings {
  double speed = 0.3;           // m/s
  double turn_deviation = 1.5;  // s, rad/s
  double turn_time = 0.5;       // tau, seconds
  double step = 0.05;           // dt, seconds
};

class RandomWalk {
 public:
  RandomWalk(const Room& room, const WalkSettings& settings, std::uint64_t seed);

  void step();
  const Eigen::Vector2d& position() const { return position_; }  // metres
  double heading() const { return heading_; }                    // radians, not reduced to a turn
  double turn_rate() const { return turn_rate_; }  // rad/s: the heading's change in the last step

 private:
  const Room* room_;
  WalkSettings settings_;
  RandomStream random_;
  Eigen::Vector2d position_;
  double heading_, wandering_ = 0.0, turn_rate_ = 0.0;
};

}  // namespace penumbra::slam::brain
