// Keeps the instances that a segmenter finds, in some frames and some frames late, as objects that last.
//
//   every frame:  before_pose() marks the features on objects that move, before the frame is located
//                 after_pose() learns from where the frame was how fast each object is, after that
//   a result of frame k:  add() gives instances to objects, by overlap, class and place, or makes new ones,
//                 follows them from frame k to the newest one, and says which features of keyframes change
//
// It is made of tracks (track.h), the history of the last frames (frame_history.h), what is believed of an
// object's motion (motion_belief.h), the association of instances with objects (instance_association.h), and
// what is told of the objects (track_report.h).
// What comes of it are marks of features, before the pose, and edits to the map.
//
// For an object that is known to move a lower score is enough: what leaves the image or is hidden more and
// more is still there. Source: Zhang et al., ByteTrack: Multi-Object Tracking by Associating Every Detection
// Box (ECCV 2022), which offers detections of low scores to what is tracked, and begins nothing new with
// them.
//
// Until there is evidence of its motion, also from the frames before it was found, an object of a class that
// usually moves counts as moving: its features are left out where enough others remain, but it covers nothing
// and takes nothing off the map. (Where the way is lost suspicion is enough against what is large: nobody
// begins anew on what may drive away.)
//
// Positions are metres in the camera's frame of the frame that they belong to. One thread uses it. It repeats
// bit for bit. Cost: about 0.1 ms an object and frame.
#pragma once

#include <utility>
#include <vector>

#include "slam/dynamics/dynamics.h"
#include "slam/dynamics/frame_history.h"
#include "slam/dynamics/instance_tracker_settings.h"
#include "slam/dynamics/motion_belief.h"
#include "slam/dynamics/track.h"

namespace penumbra::slam {

class InstanceTracker : public Dynamics {
 public:
  // `first_number`: of the objects as keyframes know them (SeenObject), TrackedInstance::id + first_number.
  InstanceTracker(const StereoCamera& camera, std::vector<double> scales,
                  const InstanceTrackerSettings& settings, int first_number = 0)
      : camera_(camera),
        settings_(settings),
        first_number_(first_number),
        belief_(camera, std::move(scales), settings),
        history_(settings.history) {}

  void before_pose(const FrameBeforePose& frame, std::vector<char>& movable) override;
  std::vector<Instance> after_pose(const FrameAfterPose& frame, std::vector<char>& movable) override;
  // Objects only where something was segmented since the last call.
  MapEdits take_edits() override;

  // The newest frame has become `keyframe`.
  void set_keyframe(KeyFrame* keyframe) { history_.newest().keyframe = keyframe; }
  // The last frames, for who looks back as well; the newest is begun by before_pose().
  const FrameHistory& history() const { return history_; }
  // Whether the frame has become a keyframe of which a late result may still tell more.
  bool is_keyframe(int frame) const;
  // Per feature of the newest frame: 1 where it lies on something that moves.
  const std::vector<char>& movable() const { return history_.newest().movable; }
  // The same of an earlier one; nullptr where it is not known any more, or is a keyframe's: then its marks
  // are the map's (take_edits).
  const std::vector<char>* movable(int frame) const;

  // What was found in frame `frame`. A result about a frame that is no longer known changes nothing.
  void add(int frame, const std::vector<Instance>& instances);
  // The same for a thing that geometry has found moving.
  void add_mover(int frame, const Instance& mover);
  // The objects of the keyframes that a late result may be about, where they changed since the last call.
  std::vector<KeyframeObjects> take_keyframe_objects();

  // Share of the newest image that is covered by what is known to move, 0..1.
  double covered_share() const;
  // What the newest frame shows, in its camera's frame.
  std::vector<SeenObject> objects() const;
  // In the order of their numbers.
  std::vector<TrackedInstance> instances() const;
  // Objects that no result can be about any more, since the last call: they are forgotten.
  std::vector<TrackedInstance> take_gone() { return std::exchange(gone_, {}); }
  // What the newest frame shows.
  std::vector<InstanceSighting> sightings() const;
  std::vector<InstanceSighting> sightings(int frame) const;

 private:
  bool follow(Track& track, const FrameRecord& from, const FrameRecord& to, const SE3& T_to_from);
  void forget_gone();
  void look_back(Track& track, const FrameRecord& at, const InstanceView& view);
  void add(const FrameRecord& at, const Instance& found, const InstanceView& view, bool moves,
           std::vector<char>& taken);
  void place(Track& track, const InstanceView& view, bool is_new);
  void mark(const Track& track, FrameRecord& at, const InstanceView& view);
  bool can_spare(const FeatureView& features, const std::vector<int>& spared) const;

  const StereoCamera camera_;
  const InstanceTrackerSettings settings_;
  const int first_number_;
  const MotionBelief belief_;
  FrameHistory history_;
  std::vector<Track> tracks_;  // in the order of their ids
  int next_id_ = 0;
  std::vector<TrackedInstance> gone_;
  std::vector<MovingFeatures> moving_features_;
  bool segmented_ = false;  // since the last take_edits()
  bool trusted_ = true;     // the newest pose is odometry's, not a guess
};

}  // namespace penumbra::slam
