// What moves, by geometry alone, without masks: what travels with the camera (companion_finder.h), and what
// has a rigid motion of its own (rigid_mover.h). That is told from the world while the frame is being
// located: each pose that the tracker tries is put to among_pairs().
//
// It marks nothing itself: what it finds is followed, and marked, by the tracker of instances.
#pragma once

#include <vector>

#include "slam/dynamics/companion_finder.h"
#include "slam/dynamics/dynamics.h"
#include "slam/dynamics/rigid_mover.h"

namespace penumbra::slam {

class Movers : public Dynamics {
 public:
  // `scales`: level_scales of the pyramid; `motion`: how well stereo knows where a point is.
  Movers(const StereoCamera& camera, std::vector<double> scales, const CompanionSettings& companions,
         const ObjectMotionSettings& motion, const RigidMoverSettings& rigid = {})
      : camera_(camera),
        scales_(std::move(scales)),
        rigid_(rigid),
        settings_(companions),
        motion_(motion),
        companions_(camera, companions) {}

  void before_pose(const FrameBeforePose& frame, std::vector<char>& movable) override;
  // Which pose is the world's. Marks in `movable`, where that is given, the frame's features on the mover.
  // It goes to after_pose() with the pose that was taken.
  WorldPose among_pairs(const PosePairs& pairs, std::vector<char>* movable) const;
  // The companion first.
  std::vector<Instance> after_pose(const FrameAfterPose& frame, std::vector<char>& movable) override;

 private:
  const StereoCamera camera_;
  const std::vector<double> scales_;
  const RigidMoverSettings rigid_;
  const CompanionSettings settings_;
  const ObjectMotionSettings motion_;
  CompanionFinder companions_;
  std::shared_ptr<const FrameFeatures> features_;  // of the frame
  int index_ = 0;
  double time_ = 0.0;
  SE3 T_co_;  // camera from odometry
  bool any_ = false;
};

}  // namespace penumbra::slam
