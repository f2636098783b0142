// Locates each frame: against the frame before it, then against the map around it.
//
//   predict the pose (constant velocity) -> match the last frame's points -> mismatch filter -> pose
//     -> match the points of the local map -> pose -> keyframe?
//
// There are several ways to locate a frame, each a function from what is known to a hypothesis
// (hypothesis.h); the tracker decides which are asked for and takes the best:
//
//   by motion        around the pose that the motion so far leads to              by_motion.h
//   by descriptors   by its likeness to the last frame, wherever that leads to    by_descriptors.h
//   by turning       where the view is covered and the way may bend               by_turning.h
//   by place         in the whole map                                             by_place.h
//
// A pose with which less than two fifths of the pairs, or map points, of the frame before agree is not clear:
// one from descriptors alone and one from the place index are tried as well, and what most map points agree
// with is taken. Only such frames pay for it, with up to three searches of the local map.
//
// A located frame may get a second look: who knows from the first pose that some of what was left out stands
// still gives it back, and the local map is searched again, from there.
//
// A frame that cannot be located is lost: its pose is the predicted one, and the tracker looks for it in the
// whole map. The next frame is compared with it as well, and where they share enough points it is known how
// the camera moved meanwhile. If several frames in a row are lost although they show enough, and the last of
// them follow from each other in this way, a new sub-map begins: a map of one frame would help nobody. What
// was computed before stays, and the loop closer merges the two when it recognises a place. In a map that was
// loaded the first frame is looked for in the same way.
//
// Where most of the view is covered by what moves, the rim that is left tells how the camera moved on
// (rim_odometry.h): that, and not the motion so far, is then what the frame is looked around with.
//
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017); mismatch filter: see
// slam/frontend/features/mismatch_filter.h.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "nn/base/stage_timer.h"
#include "slam/frontend/features/sharpness.h"
#include "slam/frontend/locating/frame.h"
#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/last_frame.h"
#include "slam/frontend/locating/locating_input.h"
#include "slam/frontend/locating/motion_model.h"
#include "slam/frontend/locating/tracker_settings.h"
#include "slam/map/map.h"
#include "slam/place/place_index.h"

namespace penumbra::slam {

// `occluded`: what moves covers so much of the view that the frame cannot be located. Nothing is wrong: the
// camera is taken to go on as before until there is something to see.
enum class TrackingState { initialising, tracking, lost, occluded };

// The pairs are those of the hypothesis that was taken; a lost frame has none.
struct TrackingReport : PairsReport {
  TrackingState state = TrackingState::initialising;
  int map_inliers = 0;     // map points that agree with the final pose
  bool recovered = false;  // a lost one, found again
  bool off_map = false;    // located by the last frame alone: its keyframe begins new ground
  bool wants_keyframe = false;
  bool starts_submap = false;               // its keyframe is the first of a new sub-map
  Matrix6d information = Matrix6d::Zero();  // of a pose that was found in the map (PoseEstimate), else 0
  bool second_pose = false;                 // located once more, with what the second look gave back
  double second_look_ms = 0.0;              // the second look, and the pose after it
};

// Told where a frame is by a first pose, and where its features are, clears the marks (`movable`) of features
// that stand still; false where there are none.
using SecondLook =
    std::function<bool(const SE3& T_cw, const FeaturePixels& pixels, std::vector<char>& movable)>;

class Tracker {
 public:
  // `who_knows`: may be empty, then what most pairs agree with is the world.
  Tracker(Map& map, const PlaceIndex& index, const TrackerSettings& settings, StageTimer& timer,
          WorldPoseFinder who_knows = {})
      : map_(map),
        index_(index),
        settings_(settings),
        timer_(timer),
        who_knows_(std::move(who_knows)),
        first_own_keyframe_(map.next_keyframe_id()),
        last_(map),
        adrift_(map),
        sharpness_(settings.least_sharpness) {}

  // Locates `frame` (what was measured is given): fills what the tracker adds (frame.h).
  TrackingReport track(Frame& frame, const SecondLook& second_look = {});

  // Tells the motion T_next_before from the frame before to the next one to be tracked, where something else
  // measures it, such as wheels. The tracker takes it in place of its prediction; without a value the tracker
  // predicts.
  void expect(const std::optional<SE3>& step) { told_step_ = step; }
  // Motion that is expected between the frame before and one at `time`.
  SE3 predicted_step(double time) const { return predicted(time) * previous_T_cw_.inverse(); }

  // Tells that the last frame tracked has become `keyframe`, which is in the map when the next one is
  // tracked.
  void set_keyframe(KeyFrame* keyframe);
  // What the next frame is compared with: the last frame that was located, and the newest where it was not.
  std::array<LastFrame*, 2> compared() { return {&last_, &adrift_}; }

 private:
  SE3 predicted(double time) const {
    if (told_step_) return *told_step_ * previous_T_cw_;
    if (step_) return *step_ * previous_T_cw_;
    return unmeasured_ == 0 ? motion_.predict(previous_T_cw_, previous_time_, time)
                            : motion_.coast(previous_T_cw_, previous_time_, time);
  }
  void look_at_rim(const Frame& frame);
  LocatingInput input(const Frame& frame, const LastFrame& last) const;
  std::optional<PosePrior> expectation(const Frame& frame, const SE3& predicted) const;
  void locate(const LocatingInput& in);
  void look_again(const LocatingInput& in, const SecondLook& second_look, TrackingReport& report);
  bool locate_from_last_frame(const LocatingInput& in);
  bool find_from_adrift(const Frame& frame);
  bool is_clear(const LocatingInput& in) const;
  bool follows_occluder(const LocatingInput& in) const;
  void take(Frame& frame);
  void count_sightings() const;
  bool shows_enough(const Frame& frame) const;
  bool start(Frame& frame);
  void remember(Frame& frame);
  void refresh_map();
  bool is_covered(const Frame& frame) const { return frame.covered_share >= settings_.occluded_share; }
  // Since the newest keyframe, as long as the frame resembles none more than that one.
  double seconds_on_new_ground(const Frame& frame) const {
    return reference_ == newest_keyframe_ ? frame.timestamp - reference_->timestamp : 0.0;
  }
  bool sharp_enough(const Frame& frame, bool wanted);
  void finish(Frame& frame, bool located, bool stepped);

  Map& map_;
  const PlaceIndex& index_;
  const TrackerSettings settings_;
  StageTimer& timer_;
  const WorldPoseFinder who_knows_;
  const int first_own_keyframe_;  // id; older ones are of a map that was loaded

  TrackingState state_ = TrackingState::initialising;
  LastFrame last_;                   // the last frame that was located
  LastFrame adrift_;                 // the frame before this one, where that was not located
  SE3 previous_T_cw_;                // of the frame before this one, located or predicted
  double previous_time_ = 0.0;       // seconds
  int pairs_ = 0, map_inliers_ = 0;  // of the last frame: with the one before, map points
  MotionModel motion_;
  Hypothesis best_, other_, spare_;            // of the frame; they keep their memory
  KeyFrame* reference_ = nullptr;              // the keyframe that shares the most points with the last frame
  const KeyFrame* newest_keyframe_ = nullptr;  // of this run
  SharpnessTest sharpness_;
  int blurred_candidates_ = 0;    // in a row
  int lost_with_view_ = 0;        // lost frames in a row that showed enough to begin a map
  std::optional<SE3> told_step_;  // from the frame before to the next one, see expect()
  std::optional<SE3> step_;       // since the frame before, as the rim of the view tells it
  RimView rim_, rim_before_;      // of this frame, and of the one before
  int unmeasured_ = 0;            // frames since the motion was measured last
  int steps_ = 0;                 // frames in a row that share points with one that was not located
};

}  // namespace penumbra::slam
