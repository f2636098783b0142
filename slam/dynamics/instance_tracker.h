// Keeps the instances that a segmenter finds, in some frames and some frames late, as objects that last.
//
//   every frame:  carry() marks the features on objects that move, before the frame is located
//                 observe() learns from where the frame was how fast each object is, after that
//   a result of frame k:  add() gives instances to objects, by overlap, class and place, or makes new ones,
//                 follows them from frame k to the newest one, and says which features of keyframes change
//
// An object has one of three states, by geometry: its class only gives the prior probability that it moves.
// Evidence is the velocity of its points with the camera's motion taken out (slam/dynamics/object_motion.h),
// also from the frames before it was found. Until there is any, a class that usually moves counts as moving:
// its features are left out where enough others remain, but it covers nothing and takes nothing off the map.
// (Where the way is lost suspicion is enough against what is large: nobody begins anew on what may drive
// away.)
//
//   log odds <- clamp(log odds + clamp(evidence))    states: fixed (cannot move), still, moving (odds > 1)
//
// Poses are those of odometry: every frame is placed relative to the one before, and later corrections of the
// map change nothing here. Positions are metres in the camera's frame of the frame that they belong to.
//
// One thread uses it. It repeats bit for bit. Cost: about 0.1 ms an object and frame.
#pragma once

#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "slam/dynamics/companion_finder.h"
#include "slam/dynamics/instance_view.h"
#include "slam/dynamics/keyframe_labels.h"
#include "slam/dynamics/object_motion.h"

namespace penumbra::slam {

enum class MotionState { fixed, still, moving };

struct InstanceTrackerSettings {
  InstanceViewSettings view;
  ObjectMotionSettings motion;
  CompanionSettings companions;
  double least_score = 0.5;         // instances below it are ignored
  bool check_motion = true;         // false: whatever can move counts as moving, as DynaSLAM's prior has it
  int history = 60;                 // frames that a late result may be about
  int frames_back = 5;              // from which a new object's points are looked up
  double longest_look = 1.0;        // seconds over which displacements are measured
  double least_overlap = 0.3;       // of masks of the same object ...
  double least_containment = 0.6;   // ... or of the smaller one's area, with the same class ...
  double nearest_metres = 1.5;      // ... or how close their places are then, plus 5 % of the depth
  int most_carried = 30;            // frames that a mask is carried without being found again
  int most_missed = 2;              // results that do not show it
  double standing_log_odds = -2.0;  // of moving, below which what can move and was measured stands
  double large_share = 0.15;        // of the image, of what is left out on suspicion where the way is lost
  // Stereo features within `close_depth` metres that must remain where one is left out on suspicion.
  int fewest_others = 50;
  double close_depth = 20.0;
};

// An object: what is known of it over all frames that showed it.
struct TrackedInstance {
  int id = 0;
  std::string class_name;  // empty: found by its motion alone
  double score = 0.0;      // the best of its detections
  int detections = 0;
  int first_frame = 0, last_frame = 0;  // that showed it
  double log_odds = 0.0;                // of moving
  bool can_move = true;
  bool measured = false;                               // whether there is evidence beside the prior
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // metres a second, odometry's frame
  Eigen::Vector3d size = Eigen::Vector3d::Zero();      // box around its points as last seen, metres
  double visible_share = 1.0;  // area of its mask, compared with the largest that it had for its depth

  double moving_probability() const { return 1.0 / (1.0 + std::exp(-log_odds)); }
  MotionState state() const {
    return log_odds > 0.0 ? MotionState::moving : can_move ? MotionState::still : MotionState::fixed;
  }
};

// What a frame showed of an object: for pictures and reports.
struct InstanceSighting {
  int id = 0;
  Rect region;
  ByteImage mask;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // camera's frame, metres
  MotionState state = MotionState::still;            // when it was last looked at
  double visible_share = 1.0;
};

class InstanceTracker {
 public:
  // `first_number`: of the objects as keyframes know them (SeenObject), TrackedInstance::id + first_number.
  InstanceTracker(const StereoCamera& camera, std::vector<double> scales,
                  const InstanceTrackerSettings& settings, int first_number = 0)
      : camera_(camera),
        scales_(std::move(scales)),
        settings_(settings),
        first_number_(first_number),
        companions_(camera, settings.companions) {}

  // Begins a frame. `T_step`: predicted motion from the last frame's camera to this one's. Marks features.
  void carry(int frame, double time, const std::shared_ptr<FrameFeatures>& features, const SE3& T_step);
  // The frame of the last carry() has been located: its true motion. Where `reliable` is false, nothing is
  // learnt about motions from it.
  void observe(const SE3& T_step, bool reliable);
  // The same frame has become `keyframe`.
  void set_keyframe(KeyFrame* keyframe) { history_.back().keyframe = keyframe; }

  // What was found in frame `frame`. A result about a frame that is no longer known changes nothing.
  void add(int frame, const std::vector<Instance>& instances);
  // The same for a thing that geometry has found moving.
  void add_mover(int frame, const Instance& mover);
  // What is to be told to the map since the last call.
  std::vector<MovingFeatures> take_moving_features();
  // The objects of the keyframes that a late result may be about, where they changed since the last call.
  std::vector<KeyframeObjects> take_keyframe_objects();

  // Share of the newest image that is covered by what is known to move, 0..1.
  double covered_share() const;
  // What the newest frame shows, in its camera's frame.
  std::vector<SeenObject> objects() const;
  const std::vector<TrackedInstance>& instances() const { return instances_; }
  // What the newest frame shows.
  std::vector<InstanceSighting> sightings() const;
  std::vector<InstanceSighting> sightings(int frame) const;

 private:
  struct FrameRecord {
    int index = 0;
    double time = 0.0;
    std::shared_ptr<FrameFeatures> features;
    SE3 T_co;               // camera from odometry
    bool observed = false;  // T_co is final, not predicted
    bool reliable = true;
    KeyFrame* keyframe = nullptr;
    std::vector<SeenObject> told;  // what the map knows of the keyframe's objects
  };
  // The part of an object that is followed from frame to frame; origins_ per feature of the newest view.
  struct Followed {
    std::deque<InstanceView> views;  // oldest first, of consecutive frames
    std::vector<PointOrigin> origins;
    int carried = 0, missed = 0;  // since it was last found
    double reference_area = 0.0;  // largest area * depth^2
    bool active = false;          // in view
  };

  const FrameRecord* record(int frame) const;
  double seconds_between(const FrameRecord& from, const FrameRecord& to) const;
  bool follow(std::size_t object, const FrameRecord& from, const FrameRecord& to, const SE3& T_to_from);
  void measure(std::size_t object, const FrameRecord& at, bool learn);
  void look_back(std::size_t object, const FrameRecord& at, const InstanceView& view);
  bool learn(TrackedInstance& instance, const std::vector<PointOrigin>& origins, const InstanceView& view,
             const FrameRecord& at);
  PointOrigin origin_of(const FrameRecord& at, int feature) const;
  std::size_t add(const FrameRecord& at, const Instance& found, const InstanceView& view, bool moves,
                  std::vector<char>& taken);
  int owner_of(const Instance& instance, const InstanceView& view, const std::vector<char>& taken) const;
  void place(std::size_t object, const InstanceView& view, bool is_new);
  void mark(std::size_t object, const FrameRecord& at, const InstanceView& view);
  bool can_spare(const FrameFeatures& features, const std::vector<int>& spared) const;
  bool moves(std::size_t object) const;
  bool stands(std::size_t object) const;
  SeenObject seen_object(std::size_t object, const InstanceView& view) const;
  template <typename Visit>
  void visit_views(int frame, Visit&& visit) const;

  const StereoCamera camera_;
  const std::vector<double> scales_;
  const InstanceTrackerSettings settings_;
  const int first_number_;
  std::deque<FrameRecord> history_;
  std::vector<TrackedInstance> instances_;  // by id
  std::vector<Followed> followed_;          // the same order
  std::vector<MovingFeatures> moving_features_;
  CompanionFinder companions_;
  bool trusted_ = true;  // the newest pose is odometry's, not a guess
};

}  // namespace penumbra::slam
