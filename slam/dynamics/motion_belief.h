// What is believed of whether an object moves, from what its points did.
//
// Evidence is the velocity of its points with the camera's motion taken out (object_motion.h), frame by
// frame:
//
//   log odds <- clamp(log odds + clamp(evidence))    states: fixed (cannot move), still, moving (odds > 1)
//
// Cost: some microseconds an object and frame.
#pragma once

#include <vector>

#include "slam/dynamics/frame_history.h"
#include "slam/dynamics/instance_tracker_settings.h"
#include "slam/dynamics/track.h"

namespace penumbra::slam {

class MotionBelief {
 public:
  MotionBelief(const StereoCamera& camera, std::vector<double> scales,
               const InstanceTrackerSettings& settings)
      : camera_(camera), scales_(std::move(scales)), settings_(settings) {}

  // A new object of the class, or, where the name is empty, of none.
  TrackedInstance prior(const std::string& class_name) const;
  // A better view of the object gives it this class: what was seen of its motion stays, the prior changes.
  void rename(TrackedInstance& instance, const std::string& class_name) const;
  // Something that geometry has found moving, without a mask.
  void presume_moving(TrackedInstance& instance) const;
  // A new object is a part of another: it moves as that does.
  void take_over(TrackedInstance& part, const TrackedInstance& whole) const;
  // What the finder of an object's mask saw of its motion. Where classes decide and not its points, this is
  // all that is known of a thing whose class cannot move.
  void hear(TrackedInstance& instance, bool moves) const;

  // Learns from where the points of `view`, of frame `at`, are now and were: true where that said anything.
  bool learn(TrackedInstance& instance, const std::vector<PointOrigin>& origins, const InstanceView& view,
             const FrameRecord& at) const;
  // The same of a track's newest view; points that were watched for long enough begin anew. Without `learns`
  // it only does that. What is measured and believed to move counts as found.
  void measure(Track& track, const FrameRecord& at, bool learns) const;

  // Where the features of a view are in frame `at`.
  std::vector<PointOrigin> origins_of(const InstanceView& view, const FrameRecord& at) const;

  // Stronger than not moving: the map may rely on it.
  bool stands(const TrackedInstance& instance) const;

 private:
  PointOrigin origin_of(const FrameRecord& at, int feature) const;

  const StereoCamera camera_;
  const std::vector<double> scales_;
  const InstanceTrackerSettings settings_;
};

}  // namespace penumbra::slam
