// What the robot feels of its own motion: speed and turn over a stretch of time.
#pragma once

#include "slam/brain/motion/plane.h"

namespace penumbra::slam::brain {

struct SelfMotion {
  double speed = 0.0;      // metres a second, forward
  double turn_rate = 0.0;  // radians a second, to the left
  double seconds = 0.0;    // for how long
};

// Where that leads: half the turn, the way, the other half, as slam/brain/position integrates it. Circles
// close; against a true arc the way is longer by a share of turn^2 / 24.
inline PlanePose step_of(const SelfMotion& motion) {
  const double turn = motion.turn_rate * motion.seconds, way = motion.speed * motion.seconds;
  return {way * std::cos(0.5 * turn), way * std::sin(0.5 * turn), wrapped_angle(turn)};
}

// The motion that leads to `step` in `seconds`; what the step has to the side is lost, since a wheeled robot
// cannot go there.
inline SelfMotion motion_of(const PlanePose& step, double seconds) {
  const double half = 0.5 * step.heading;
  return {(step.x * std::cos(half) + step.y * std::sin(half)) / seconds, step.heading / seconds, seconds};
}

}  // namespace penumbra::slam::brain
