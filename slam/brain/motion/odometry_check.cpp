#include "slam/brain/motion/odometry_check.h"

#include <fmt/core.h>

namespace penumbra::slam::brain {

void OdometryCheck::add(const PlanePose& felt, const PlanePose& seen) {
  if (!felt.is_finite() || !seen.is_finite()) return;
  ++steps_;
  felt_ += felt.x;
  seen_ += seen.x;
  turned_both_ += felt.heading * seen.heading;
  turned_ += seen.heading * seen.heading;
}

std::string OdometryCheck::doubt() const {
  constexpr int kFewestSteps = 10;
  constexpr double kLeastWay = 2.0, kLeastTurned = 0.1;  // metres, radians squared
  if (steps_ < kFewestSteps) return {};
  if (seen_ > kLeastWay) {
    const double way = felt_ / seen_;
    if (way < 0.0)
      return "the odometry drives backwards where the images show a way ahead: is the speed's sign right?";
    if (way < 0.6 || way > 1.7)
      return fmt::format(
          "the odometry has {:.2f} m for each metre that was seen: are its speeds metres a second?", way);
  }
  if (turned_ > kLeastTurned) {
    const double turns = turned_both_ / turned_;
    if (turns < 0.0)
      return "the odometry turns the other way than the images show: are its turns to the left?";
    if (turns < 0.5 || turns > 2.0)
      return fmt::format("the odometry turns {:.2f} times as far as was seen: is it radians a second?",
                         turns);
  }
  return {};
}

}  // namespace penumbra::slam::brain
