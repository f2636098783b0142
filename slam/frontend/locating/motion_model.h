// Predicts the next pose from the last motion: constant velocity.
//
//   T_k,w = exp( s log(T_k-1,k-2) ) T_k-1,w       s = (t_k - t_k-1) / (t_k-1 - t_k-2)
//
// Where frames in a row could not be located the last motion alone is a poor guide: its errors add up.
// coast() predicts from the mean of the last motions, in which a new one counts two fifths.
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
    return SE3::exp(ratio(time - last_time) * velocity_) * T_last_w;
  }
  SE3 coast(const SE3& T_last_w, double last_time, double time) const {
    if (!known_) return T_last_w;
    return SE3::exp(ratio(time - last_time) * mean_velocity_) * T_last_w;
  }
  // The motion between the last two frames that were located.
  void observe(const SE3& T_cw, const SE3& T_last_w, double last_time, double time) {
    velocity_ = (T_cw * T_last_w.inverse()).log();
    mean_velocity_ =
        known_ ? Vector6d(mean_velocity_ + kShareOfNew * (velocity_ - mean_velocity_)) : velocity_;
    step_ = time - last_time;
    known_ = velocity_.allFinite() && mean_velocity_.allFinite();
  }
  bool known() const { return known_; }

 private:
  static constexpr double kShareOfNew = 0.4;

  double ratio(double step) const {
    const double ratio = step / step_;
    return step_ > 0.0 && ratio > 0.05 && ratio < 5.0 ? ratio : 1.0;
  }

  bool known_ = false;
  Vector6d velocity_ = Vector6d::Zero(), mean_velocity_ = Vector6d::Zero();  // per `step_`
  double step_ = 0.0;  // seconds; NaN or not positive where the times are no help
};

}  // namespace penumbra::slam
