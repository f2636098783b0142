// Predicts the next pose from the last motion: constant velocity.
//
//   T_k,w = exp( s log(T_k-1,k-2) ) T_k-1,w       s = (t_k - t_k-1) / (t_k-1 - t_k-2)
//
// s is 1 where the times do not say otherwise (missing, equal, running backwards, or a jump of more than 5
// steps).
#pragma once

#include "slam/geometry/se3.h"

namespace penumbra::slam {

class MotionModel {
 public:
  // T_cw of the next frame, given that of the last one. Without a motion yet: the last pose.
  SE3 predict(const SE3& T_last_w, double last_time, double time) const {
    if (!known_) return T_last_w;
    const double step = time - last_time, ratio = step / step_;
    if (step_ > 0.0 && ratio > 0.05 && ratio < 5.0) return SE3::exp(ratio * velocity_) * T_last_w;
    return SE3::exp(velocity_) * T_last_w;
  }
  // The motion between the last two frames that were located.
  void observe(const SE3& T_cw, const SE3& T_last_w, double last_time, double time) {
    velocity_ = (T_cw * T_last_w.inverse()).log();
    step_ = time - last_time;
    known_ = velocity_.allFinite();
  }
  void forget() { known_ = false; }
  bool known() const { return known_; }

 private:
  bool known_ = false;
  Vector6d velocity_ = Vector6d::Zero();  // per `step_`
  double step_ = 0.0;                     // seconds; NaN or not positive where the times are no help
};

}  // namespace penumbra::slam
