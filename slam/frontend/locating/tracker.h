// Locates each frame: against the frame before it, then against the map around it.
//
//   predict the pose (constant velocity) -> match the last frame's points -> mismatch filter -> pose
//     -> match the points of the local map -> pose -> keyframe?
//
// A pose with which less than two fifths of the pairs, or map points, of the frame before agree is not clear:
// one from descriptors alone and one from the place index are tried as well, and what most map points agree
// with is taken. Only such frames pay for it, with up to three searches of the local map.
//
// A frame that cannot be located is lost: its pose is the predicted one, and the tracker looks for it in the
// whole map (recognition.h). If that fails for several frames in a row although they show enough, a new
// sub-map begins at the predicted pose: what was computed before stays, and the loop closer merges the two
// when it recognises a place. In a map that was loaded the first frame is looked for in the same way.
//
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017); mismatch filter: see
// slam/frontend/features/mismatch_filter.h.
#pragma once

#include <span>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/dynamics/rigid_mover.h"
#include "slam/frontend/features/frame_matcher.h"
#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/features/sharpness.h"
#include "slam/frontend/locating/frame.h"
#include "slam/frontend/locating/keyframe_choice.h"
#include "slam/frontend/locating/last_frame.h"
#include "slam/frontend/locating/motion_model.h"
#include "slam/geometry/pose_optimizer.h"
#include "slam/map/map.h"
#include "slam/place/recognition.h"

namespace penumbra::slam {

// `occluded`: what moves covers so much of the view that the frame cannot be located. Nothing is wrong: the
// camera is taken to go on as before until there is something to see.
enum class TrackingState { initialising, tracking, lost, occluded };

struct TrackerSettings {
  MismatchFilterSettings mismatch_filter;
  RigidMoverSettings rigid_mover;
  double occluded_share = 0.3;       // of the image, covered by what moves, for a lost frame to be `occluded`
  float search_radius = 10.0F;       // pixels at level 0, around a projection with a known motion
  float wide_search_radius = 30.0F;  // the same when that finds too little
  float map_search_radius = 4.0F;    // around a projection with the frame's own pose
  int fewest_initial_points = 50;    // stereo points that the first frame needs
  int fewest_frame_inliers = 20;     // of the match to the last frame
  double clear_share = 0.4;          // of the last frame's inliers: with fewer, another pose is tried, too
  int fewest_map_inliers = 20;       // of the match to the local map ...
  int fewest_step_inliers = 50;      // ... or, where the map has too few, of the match to the last frame
  int fewest_occluded_inliers = 8;   // of any, where what moves covers `occluded_share` of the view
  double largest_surprise = 0.4;     // metres between prediction and pose, where the view is covered
  int local_keyframes = 20;          // whose points make the local map
  RecognitionSettings recognition;   // of a lost frame
  int lost_before_restart = 5;       // lost frames with enough points after which a new sub-map begins
  int occluded_before_restart = 1;   // the same for occluded ones
  int fewest_covered_points = 20;    // stereo points that such a frame needs
  KeyframeSettings keyframes;        // which frames become one
  // How much the motion may change from frame to frame: what it is worth where the view is covered.
  double motion_change_metres = 0.1, motion_change_radians = 0.02;
  bool extends_map = true;  // false: the map stays as it is, the camera is only located in it
  // A frame below this share of the usual sharpness (slam/frontend/features/sharpness.h) leaves it to one of
  // the next frames to become the keyframe; 0: no blur test.
  double least_sharpness = 0.0;
  int longest_sharpness_wait = 3;  // frames
};

// What comparing a frame with the last one showed.
struct PairsReport {
  int frame_matches = 0;          // pairs
  MismatchFilterReport filter;    // what the mismatch filter did with them
  int frame_inliers = 0;          // pairs that agree with the pose
  std::optional<Instance> mover;  // a large thing that moves, found by geometry alone
};

// The pairs are those of the attempt that located the frame; a lost frame has none.
struct TrackingReport : PairsReport {
  TrackingState state = TrackingState::initialising;
  int map_inliers = 0;     // map points that agree with the final pose
  bool recovered = false;  // a lost one, found again
  bool off_map = false;    // located by the last frame alone: its keyframe begins new ground
  bool wants_keyframe = false;
  bool starts_submap = false;  // its keyframe is the first of a new sub-map
};

class Tracker {
 public:
  Tracker(Map& map, const PlaceIndex& index, const TrackerSettings& settings, StageTimer& timer)
      : map_(map),
        index_(index),
        settings_(settings),
        timer_(timer),
        first_own_keyframe_(map.next_keyframe_id()),
        last_(map),
        sharpness_(settings.least_sharpness) {}

  // Locates `frame` (its features are given): fills pose, points and reference.
  TrackingReport track(Frame& frame);

  // Motion that is expected between the frame before and one at `time`.
  SE3 predicted_step(double time) const { return predicted(time) * previous_T_cw_.inverse(); }

  // Tells that the last frame tracked has become `keyframe`, which is in the map when the next one is
  // tracked.
  void set_keyframe(KeyFrame* keyframe);

 private:
  struct Located {
    bool success = false;
    int pairs = 0;         // with the last frame that agree
    int inliers = 0;       // map points that agree; off the map: pairs
    bool off_map = false;  // by the last frame alone: the map does not reach here yet
    bool clear = true;     // false: another pose may have more inliers
  };
  // What an attempt to locate the frame has made of it, to go back to.
  struct Attempt {
    SE3 T_cw;
    std::vector<MapPoint*> points;  // as Frame's
    std::vector<char> aligned;
    std::vector<Keypoint> keypoints;
    std::vector<float> right_columns;
    std::vector<char> movable;
    PairsReport pairs;
    std::vector<LoosePoint> loose;  // as the members
    std::vector<MapPoint*> looked_for;
    KeyFrame* reference = nullptr;
  };

  SE3 predicted(double time) const {
    return state_ == TrackingState::tracking ? motion_.predict(previous_T_cw_, previous_time_, time)
                                             : motion_.coast(previous_T_cw_, previous_time_, time);
  }
  std::optional<PosePrior> expectation(const Frame& frame, const SE3& predicted) const;
  bool follows_occluder(const Frame& frame, const SE3& predicted) const;
  bool shows_enough(const Frame& frame) const;
  bool start(Frame& frame);
  void remember(Frame& frame);
  void refresh_map();
  Located locate_by_prediction(Frame& frame, const SE3& predicted, TrackingReport& report);
  Located locate_by_turning(Frame& frame, const SE3& start, TrackingReport& report);
  std::optional<SE3> pose_from_descriptors(const Frame& frame) const;
  Located locate_around(Frame& frame, const SE3& start, bool may_leave_map, TrackingReport& report);
  Located locate_from_last_frame(Frame& frame, float radius, TrackingReport& report);
  Located locate_in_local_map(Frame& frame);
  Located recognise(Frame& frame);
  std::vector<KeyFrame*> keyframes_near() const;
  bool is_clear(int inliers, int before) const;
  void keep(const Frame& frame, const PairsReport& report, Attempt& attempt) const;
  Attempt attempt(const Frame& frame, const PairsReport& report) const;
  void take(const Attempt& attempt, Frame& frame, PairsReport& report);
  void forget_attempt(Frame& frame, PairsReport& report) { take(untouched_, frame, report); }
  void count_sightings(const Frame& frame);
  std::vector<Match> filter_matches(const std::vector<Match>& matches,
                                    const std::vector<MatchedPixels>& pixels, TrackingReport& report) const;
  PoseEstimate leave_out_mover(Frame& frame, std::span<const PoseObservation> observations,
                               const PoseEstimate& estimate, TrackingReport& report) const;
  bool is_covered(const Frame& frame) const { return frame.covered_share >= settings_.occluded_share; }
  bool sharp_enough(const Frame& frame, bool wanted);
  void finish(Frame& frame, bool located);

  Map& map_;
  const PlaceIndex& index_;
  const TrackerSettings settings_;
  StageTimer& timer_;
  const int first_own_keyframe_;  // id; older ones are of a map that was loaded

  TrackingState state_ = TrackingState::initialising;
  LastFrame last_;                     // the last frame that was located
  SE3 previous_T_cw_;                  // of the frame before this one, located or predicted
  double previous_time_ = 0.0;         // seconds
  int pairs_ = 0, map_inliers_ = 0;    // of the last frame: with the one before, map points
  Attempt untouched_;                  // the frame before the first attempt
  std::vector<LoosePoint> loose_;      // that the frame shows
  std::vector<MapPoint*> looked_for_;  // that the frame should show
  MotionModel motion_;
  std::optional<PosePrior> prior_;  // of the frame, where its view is covered
  KeyFrame* reference_ = nullptr;   // the keyframe that shares the most points with the last frame
  int frames_since_keyframe_ = 0;
  SharpnessTest sharpness_;
  int blurred_candidates_ = 0;  // in a row
  int lost_with_view_ = 0;      // lost frames in a row that showed enough to begin a map
  int unlocated_ = 0;           // frames since the last that was located
};

}  // namespace penumbra::slam
