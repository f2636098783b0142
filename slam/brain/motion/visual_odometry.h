// Self-motion by sight: the tracking of slam/pipeline without loops and without adjusting the whole map, of
// which only the motion from frame to frame is taken.
#pragma once

#include "slam/brain/motion/camera_mount.h"
#include "slam/brain/motion/self_motion.h"
#include "slam/pipeline/slam.h"

namespace penumbra::slam::brain {

class VisualOdometry {
 public:
  VisualOdometry(const StereoCamera& camera, Sensor sensor, int threads, const CameraMount& mount = {});
  // Since the frame before; a frame that is lost goes on as the last ones did.
  SelfMotion next(const StereoImages& images);
  int lost() const { return lost_; }  // frames
  // Of the way so far, the share that goes up or down: a robot on the ground has a few per cent, a camera in
  // the hand or the air 20 and more, and no place in the plane. 0 without a way.
  double climb_share() const { return way_ > 0.0 ? climbed_ / way_ : 0.0; }
  // The share that leads to the robot's side, which wheels do not do.
  double side_share() const { return way_ > 0.0 ? aside_ / way_ : 0.0; }

 private:
  Slam slam_;
  CameraMount mount_;
  std::optional<TimedPose> last_;
  int lost_ = 0;
  double way_ = 0.0, climbed_ = 0.0, aside_ = 0.0;  // metres
};

}  // namespace penumbra::slam::brain
