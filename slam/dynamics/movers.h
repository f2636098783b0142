// What moves, by geometry alone, without masks: what travels with the camera (companion_finder.h), and what
// has a rigid motion of its own (rigid_mover.h), which is found along with the pose.
//
// It marks nothing itself: what it finds is followed, and marked, by the tracker of instances.
#pragma once

#include <vector>

#include "slam/dynamics/companion_finder.h"
#include "slam/dynamics/dynamics.h"

namespace penumbra::slam {

class Movers : public Dynamics {
 public:
  // `scales`: level_scales of the pyramid; `motion`: how well stereo knows where a point is.
  Movers(const StereoCamera& camera, std::vector<double> scales, const CompanionSettings& companions,
         const ObjectMotionSettings& motion)
      : camera_(camera),
        scales_(std::move(scales)),
        settings_(companions),
        motion_(motion),
        companions_(camera, companions) {}

  void before_pose(const FrameBeforePose& frame, std::vector<char>& movable) override;
  // The companion first.
  std::vector<Instance> after_pose(const FrameAfterPose& frame, std::vector<char>& movable) override;

 private:
  const StereoCamera camera_;
  const std::vector<double> scales_;
  const CompanionSettings settings_;
  const ObjectMotionSettings motion_;
  CompanionFinder companions_;
  std::shared_ptr<const FrameFeatures> features_;  // of the frame
  double time_ = 0.0;
  SE3 T_co_;  // camera from odometry
  bool any_ = false;
};

}  // namespace penumbra::slam
