// How far off the felt speed and turns are, learned from what is seen of the same steps.
//
//   gain  g = sum w m_seen / sum w m_felt           w: falls by 1/e over `metres` of way
//   bias  b = sum u (a_seen - a_felt) / sum u t     u: falls by 1/e over `seconds`
//
// m: metres of a step, a: radians that it turns, t: seconds that it takes. Corrected are v <- g v and
// omega <- omega + b. At the start g = 1 and b = 0, with the weight of `metres` / 10 and `seconds` / 10. A
// step that was felt to go other ways than it was seen to, as when wheels slip, teaches nothing.
//
// Cost: nothing to speak of. Source: place cells recalibrate path integration by landmarks in the same way:
// Jayakumar et al., Recalibration of path integration in hippocampal place cells (Nature 2019).
#pragma once

#include "slam/brain/motion/self_motion.h"

namespace penumbra::slam::brain {

class OdometryCalibration {
 public:
  OdometryCalibration(double metres, double seconds)
      : metres_(metres), seconds_(seconds), seen_(0.1 * metres), felt_(0.1 * metres), time_(0.1 * seconds) {}

  SelfMotion corrected(const SelfMotion& motion) const {
    return {gain() * motion.speed, motion.turn_rate + bias(), motion.seconds};
  }
  double gain() const { return seen_ / felt_; }
  double bias() const { return turned_ / time_; }  // radians a second

  // `felt`: uncorrected, as it was seen it: `seen`; in `seconds`. Whether it was of use.
  bool learn(const PlanePose& felt, const PlanePose& seen, double seconds);

 private:
  double metres_, seconds_;
  double seen_, felt_;  // metres, weighted
  double turned_ = 0.0, time_;
};

}  // namespace penumbra::slam::brain
