#include "slam/brain/motion/visual_odometry.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam::brain {

namespace {

SlamSettings odometry_settings(int threads) {
  SlamSettings settings;
  settings.deterministic = true;
  settings.threads = threads;
  settings.loops.enabled = false;
  return settings;
}

}  // namespace

VisualOdometry::VisualOdometry(const StereoCamera& camera, Sensor sensor, int threads,
                               const CameraMount& mount)
    : slam_(camera, sensor, odometry_settings(threads)), mount_(mount) {}

SelfMotion VisualOdometry::next(const StereoImages& images) {
  const FrameResult result = slam_.process(images);
  const TimedPose now{result.timestamp, result.T_wc};
  lost_ += result.tracking.state == TrackingState::lost;
  SelfMotion motion;
  if (last_) {
    // Two frames of one time still are a step.
    constexpr double kLeastSeconds = 1e-6;
    const SE3 step = mount_.to_robot(last_->T_wc.inverse() * now.T_wc);
    motion = motion_of(plane_pose(step), std::max(kLeastSeconds, now.timestamp - last_->timestamp));
    way_ += step.translation.norm();
    climbed_ +=
        std::abs(mount_.to_robot(now.T_wc).translation.y() - mount_.to_robot(last_->T_wc).translation.y());
    aside_ += std::abs(step.translation.x());
  }
  last_ = now;
  return motion;
}

}  // namespace penumbra::slam::brain
