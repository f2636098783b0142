#include "slam/frontend/locating/tracker.h"

#include <utility>

#include "nn/base/stopwatch.h"
#include "slam/frontend/locating/by_descriptors.h"
#include "slam/frontend/locating/by_motion.h"
#include "slam/frontend/locating/by_place.h"
#include "slam/frontend/locating/by_turning.h"
#include "slam/frontend/locating/local_map_search.h"

namespace penumbra::slam {

TrackingReport Tracker::track(Frame& frame, const SecondLook& second_look) {
  TrackingReport report;
  frame.points.assign(static_cast<std::size_t>(frame.features->size()), nullptr);
  frame.aligned.assign(frame.points.size(), 0);
  frame.pixels.reset();
  if (state_ == TrackingState::initialising && map_.keyframes().empty()) {
    report.wants_keyframe = start(frame);
    report.state = state_;
    return report;
  }

  refresh_map();
  look_at_rim(frame);
  const LocatingInput in = input(frame, last_);
  locate(in);
  if (best_.success && follows_occluder(in)) best_.success = false;
  const bool located = best_.success || find_from_adrift(frame);
  const bool stepped = !located && (best_.off_map || step_);
  if (located) {
    pairs_ = best_.report.frame_inliers;
    map_inliers_ = best_.off_map ? 0 : best_.inliers;
    if (second_look && !best_.off_map) look_again(in, second_look, report);
    static_cast<PairsReport&>(report) = std::move(best_.report);
    report.map_inliers = best_.inliers;
    report.off_map = best_.off_map;
    report.information = best_.information;
    report.recovered = state_ == TrackingState::lost || state_ == TrackingState::occluded;
    if (settings_.extends_map && !best_.off_map) count_sightings();
    take(frame);
  } else if (best_.off_map) {
    static_cast<PairsReport&>(report) = std::move(best_.report);
    take(frame);
  } else {
    frame.T_cw = in.predicted;
  }
  finish(frame, located, stepped);
  report.wants_keyframe = sharp_enough(
      frame, settings_.extends_map && located &&
                 (report.off_map ||
                  becomes_keyframe(frame, *reference_, seconds_on_new_ground(frame), settings_.keyframes)));
  const bool occluded = state_ == TrackingState::occluded;
  const int patience = occluded ? settings_.occluded_before_restart : settings_.lost_before_restart;
  if (settings_.extends_map && lost_with_view_ >= patience && steps_ >= settings_.steps_before_restart) {
    report.wants_keyframe = report.starts_submap = start(frame);
  }
  report.state = state_;
  return report;
}

LocatingInput Tracker::input(const Frame& frame, const LastFrame& last) const {
  LocatingInput in{frame, last, map_, index_, settings_, timer_, predicted(frame.timestamp)};
  in.motion_known = motion_.known() || told_step_;
  in.prior = expectation(frame, in.predicted);
  in.last_pairs = pairs_;
  in.last_inliers = map_inliers_;
  in.reference = reference_;
  in.first_own_keyframe = first_own_keyframe_;
  if (who_knows_) in.who_knows = &who_knows_;
  return in;
}

// Where most of the view is covered the rim that is left tells how the camera moved on.
void Tracker::look_at_rim(const Frame& frame) {
  step_.reset();
  std::swap(rim_, rim_before_);
  rim_.clear();
  if (frame.covered_share < settings_.rim.least_covered || frame.right == nullptr) return;
  const auto scope = timer_.measure("rim");
  collect_rim(frame.view(), *frame.right, rim_);
  // How far the camera goes the mean tells better than the last step, which few points have measured.
  const SE3 predicted = motion_.coast(previous_T_cw_, previous_time_, frame.timestamp);
  const std::optional<PosePrior> expected = expectation(frame, predicted);
  if (!expected || rim_before_.empty()) return;
  step_ =
      rim_step(map_.camera(), map_.scales(), rim_before_, rim_,
               {predicted * previous_T_cw_.inverse(), expected->metres, expected->radians}, settings_.rim);
}

// What hides the view leaves few points, which a mismatch can lead astray: there, what the motion so far
// leads to expect counts, too. The longer ago it was measured, the less.
std::optional<PosePrior> Tracker::expectation(const Frame& frame, const SE3& predicted) const {
  if (!is_covered(frame) || !motion_.known()) return std::nullopt;
  if (step_) return PosePrior{predicted, settings_.rim.metres, settings_.rim.radians};
  const double steps = 1.0 + unmeasured_;
  return PosePrior{predicted, steps * settings_.motion_change_metres,
                   steps * settings_.motion_change_radians};
}

// Finds the best hypothesis: from the last frame, and where that leaves a doubt, from the whole map.
void Tracker::locate(const LocatingInput& in) {
  best_.begin(in.frame, in.reference);
  const bool clear = !last_.empty() && locate_from_last_frame(in);
  if (best_.success && !best_.off_map && clear) return;
  locate_by_place(in, other_);
  if (other_.success && (best_.off_map || other_.inliers > best_.inliers)) std::swap(best_, other_);
}

// Against the frame before, which was not located itself. True where that leads back into the map; else
// `best_` is off the map where it was found how the camera moved since that frame.
bool Tracker::find_from_adrift(const Frame& frame) {
  best_.off_map = false;
  if (adrift_.empty()) return false;
  LocatingInput in = input(frame, adrift_);
  in.last_pairs = in.last_inliers = 0;
  best_.begin(frame, in.reference);
  locate_from_last_frame(in);
  if (best_.success && !follows_occluder(in)) return !best_.off_map;
  best_.off_map = false;
  return false;
}

// The second pose, from the first, with what stands still after all. The first stays where it fails.
void Tracker::look_again(const LocatingInput& in, const SecondLook& second_look, TrackingReport& report) {
  const Stopwatch watch;
  other_ = best_;
  if (second_look(best_.T_cw, best_.pixels, best_.movable)) {
    for (std::size_t i = 0; i < best_.points.size() && i < best_.movable.size(); ++i) {
      if (best_.movable[i] != 0) best_.points[i] = nullptr;
    }
    search_local_map(in, in.prior, best_);
    report.second_pose = best_.success;
    if (!best_.success) std::swap(best_, other_);
  }
  report.second_look_ms = watch.milliseconds();
}

// Around the predicted pose. Where that is not clear, a wrong pose may have found itself a few pairs, as on a
// chessboard: then descriptors are asked for another, and the one with which more of the map agrees is taken.
// Returns whether the hypothesis leaves no doubt.
bool Tracker::locate_from_last_frame(const LocatingInput& in) {
  SE3 start = in.predicted;
  if (in.motion_known) locate_by_motion(in, best_, spare_);
  // Where the view is covered, descriptors would mostly find what covers it.
  if (!is_clear(in) && !in.prior) {
    const std::optional<SE3> rough = pose_by_descriptors(in);
    if (rough) start = *rough;
    locate_by_descriptors(in, rough, other_, spare_);
    if (other_.success && (other_.off_map ? !best_.success : other_.inliers > best_.inliers)) {
      std::swap(best_, other_);
    }
  }
  if (!best_.success && in.prior) locate_by_turning(in, start, best_, spare_);
  return in.prior || best_.off_map || is_clear(in);
}

// Whether no other pose will have more pairs and map points than the best hypothesis.
bool Tracker::is_clear(const LocatingInput& in) const {
  return best_.success && in.is_clear(best_.pairs(), in.last_pairs) &&
         in.is_clear(best_.inliers, in.last_inliers);
}

// Whether the pose is probably that of something large in front of the camera: the motion so far does not
// lead to it, or the rim tells another turn.
bool Tracker::follows_occluder(const LocatingInput& in) const {
  if (!is_covered(in.frame) || unmeasured_ > 0 || !motion_.known()) return false;
  constexpr double kDoubt = 3.0;  // deviations of what the rim tells
  const SE3 surprise = best_.T_cw * in.predicted.inverse();
  return surprise.translation.norm() > settings_.largest_surprise ||
         (step_ && surprise.angle() > kDoubt * settings_.rim.radians);
}

// The frame is where the best hypothesis has it.
void Tracker::take(Frame& frame) {
  frame.T_cw = best_.T_cw;
  std::swap(frame.points, best_.points);
  std::swap(frame.aligned, best_.aligned);
  std::swap(frame.movable, best_.movable);
  frame.pixels = std::make_shared<const FeaturePixels>(best_.pixels);
  reference_ = best_.reference;
}

// How often a point is found where it should be seen decides whether it stays (local_mapper.h).
void Tracker::count_sightings() const {
  for (MapPoint* point : best_.looked_for) ++point->visible;
  for (MapPoint* point : best_.points) {
    if (point != nullptr) ++point->found;
  }
}

// Whether the frame has enough stereo points to begin a map with.
bool Tracker::shows_enough(const Frame& frame) const {
  const FeatureView features = frame.view();
  int points = 0;
  for (int i = 0; i < features.size(); ++i) points += features.has_stereo(i) && !features.is_movable(i);
  return points >= (is_covered(frame) ? settings_.fewest_covered_points : settings_.fewest_initial_points);
}

// Begins a map, or continues one, at the frame's pose: true if it shows enough points with stereo depth.
bool Tracker::start(Frame& frame) {
  if (!shows_enough(frame)) return false;
  state_ = TrackingState::tracking;
  remember(frame);
  return true;
}

// `frame` is located: the next one is compared with it.
void Tracker::remember(Frame& frame) {
  last_.remember(frame);
  previous_T_cw_ = frame.T_cw;
  previous_time_ = frame.timestamp;
  lost_with_view_ = unmeasured_ = steps_ = 0;
  adrift_.forget();
}

void Tracker::set_keyframe(KeyFrame* keyframe) {
  newest_keyframe_ = reference_ = keyframe;
  last_.set_keyframe(keyframe);
}

// The map has changed since the last frame: poses were adjusted, points merged or removed.
void Tracker::refresh_map() {
  last_.refresh();
  if (state_ == TrackingState::tracking) previous_T_cw_ = last_.T_cw();
  adrift_.refresh();
  if (!adrift_.empty()) previous_T_cw_ = adrift_.T_cw();
  while (reference_ != nullptr && reference_->erased) reference_ = reference_->stand_in;
  map_.readers_let_go();
}

// Whether the frame becomes the keyframe that is wanted, if one is.
bool Tracker::sharp_enough(const Frame& frame, bool wanted) {
  const bool sharp = frame.pyramid->levels() < 2 || sharpness_.is_sharp(frame.pyramid->level(1));
  if (!wanted) return false;
  const bool takes = sharp || ++blurred_candidates_ > settings_.longest_sharpness_wait;
  if (takes) blurred_candidates_ = 0;
  return takes;
}

void Tracker::finish(Frame& frame, bool located, bool stepped) {
  if (reference_ != nullptr) {
    frame.reference = reference_;
    frame.T_c_reference = frame.T_cw * current_pose(*reference_).inverse();
  }
  if (located) {
    // The motion since a frame that was lost is no velocity.
    if (state_ == TrackingState::tracking) {
      motion_.observe(frame.T_cw, last_.T_cw(), last_.timestamp(), frame.timestamp);
    }
    state_ = TrackingState::tracking;
    remember(frame);
  } else {
    state_ = is_covered(frame) ? TrackingState::occluded : TrackingState::lost;
    steps_ = best_.off_map ? steps_ + 1 : 0;
    if (stepped) {
      motion_.observe(frame.T_cw, previous_T_cw_, previous_time_, frame.timestamp);
      unmeasured_ = 0;
    } else {
      ++unmeasured_;
    }
    previous_T_cw_ = frame.T_cw;
    previous_time_ = frame.timestamp;
    lost_with_view_ += shows_enough(frame);
    adrift_.remember(frame);
  }
}

}  // namespace penumbra::slam
