// Whether the felt motion and the seen one are of one kind: units and signs of odometry are easily wrong, and
// sight would repair most of it in silence.
//
//   way     sum m_felt / sum m_seen                          1 where both are right; 3.6 of km/h
//   turns   sum a_felt a_seen / sum a_seen^2                 1; 57.3 of degrees; -1 where left is right
//
// m: metres of a step, negative backwards, a: radians that it turns. A cheap encoder is a few per cent off.
#pragma once

#include <string>

#include "slam/brain/motion/plane.h"

namespace penumbra::slam::brain {

class OdometryCheck {
 public:
  void add(const PlanePose& felt, const PlanePose& seen);
  // For people, such as "the odometry has 3.60 m for each metre that was seen: ..."; empty where both agree
  // or too little was seen.
  std::string doubt() const;

 private:
  int steps_ = 0;
  double felt_ = 0.0, seen_ = 0.0;           // metres
  double turned_both_ = 0.0, turned_ = 0.0;  // radians squared
};

}  // namespace penumbra::slam::brain
