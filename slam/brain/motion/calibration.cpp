#include "slam/brain/motion/calibration.h"

#include <algorithm>

namespace penumbra::slam::brain {

bool OdometryCalibration::learn(const PlanePose& felt, const PlanePose& seen, double seconds) {
  // What a slip makes of a step: beyond that it is no matter of gain and bias.
  constexpr double kMostRatio = 1.25, kMostTurnRate = 0.1;  // radians a second, beside 0.02 rad
  if (!(seconds > 0.0) || !felt.is_finite() || !seen.is_finite()) return false;
  const double way_felt = felt.distance(), way_seen = seen.distance();
  const double turn = wrapped_angle(seen.heading - felt.heading);
  constexpr double kLeastWay = 0.05;  // metres
  if (way_felt > kLeastWay &&
      (way_seen > kMostRatio * way_felt || way_felt > kMostRatio * way_seen || felt.x * seen.x < 0.0))
    return false;
  if (std::abs(turn) > 0.02 + kMostTurnRate * seconds) return false;
  const double keep_way = std::exp(-way_felt / metres_), keep_time = std::exp(-seconds / seconds_);
  seen_ = keep_way * seen_ + way_seen;
  felt_ = keep_way * felt_ + way_felt;
  turned_ = keep_time * turned_ + turn;
  time_ = keep_time * time_ + seconds;
  return true;
}

}  // namespace penumbra::slam::brain
