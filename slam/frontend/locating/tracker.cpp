#include "slam/frontend/locating/tracker.h"

#include <algorithm>
#include <cmath>

#include "slam/frontend/features/measurement.h"
#include "slam/frontend/locating/local_map.h"
#include "slam/frontend/locating/map_matching.h"
#include "slam/geometry/pnp_ransac.h"

namespace penumbra::slam {

TrackingReport Tracker::track(Frame& frame) {
  TrackingReport report;
  frame.points.assign(static_cast<std::size_t>(frame.features->size()), nullptr);
  frame.aligned.assign(frame.points.size(), 0);
  if (state_ == TrackingState::initialising && map_.keyframes().empty()) {
    report.wants_keyframe = start(frame);
    report.state = state_;
    return report;
  }

  refresh_map();
  loose_.clear();
  looked_for_.clear();
  keep(frame, report, untouched_);
  const SE3 predicted = this->predicted(frame.timestamp);
  prior_ = expectation(frame, predicted);
  Located located = locate_by_prediction(frame, predicted, report);
  if (!located.success || located.off_map || !located.clear) {
    const Attempt by_prediction = attempt(frame, report);
    prior_.reset();
    forget_attempt(frame, report);
    const Located recognised = recognise(frame);
    if (recognised.success && (located.off_map || recognised.inliers > located.inliers)) {
      located = recognised;
    } else {
      take(by_prediction, frame, report);
    }
  }
  if (located.success && follows_occluder(frame, predicted)) located = {};
  report.map_inliers = located.inliers;
  report.off_map = located.success && located.off_map;
  report.recovered = located.success && (state_ == TrackingState::lost || state_ == TrackingState::occluded);
  if (!located.success) {
    forget_attempt(frame, report);
    frame.T_cw = predicted;
  } else {
    pairs_ = located.pairs;
    map_inliers_ = located.off_map ? 0 : located.inliers;
    if (settings_.extends_map && !located.off_map) count_sightings(frame);
  }
  finish(frame, located.success);
  report.wants_keyframe =
      sharp_enough(frame, settings_.extends_map && located.success &&
                              (located.off_map || becomes_keyframe(frame, *reference_, frames_since_keyframe_,
                                                                   settings_.keyframes)));
  const bool occluded = state_ == TrackingState::occluded;
  const int patience = occluded ? settings_.occluded_before_restart : settings_.lost_before_restart;
  if (settings_.extends_map && lost_with_view_ >= patience) {
    report.wants_keyframe = report.starts_submap = start(frame);
  }
  report.state = state_;
  return report;
}

// What hides the view leaves few points, which a mismatch can lead astray: there, what the motion so far
// leads to expect counts, too. The longer ago it was measured, the less.
std::optional<PosePrior> Tracker::expectation(const Frame& frame, const SE3& predicted) const {
  if (!is_covered(frame) || !motion_.known()) return std::nullopt;
  const double steps = 1.0 + unlocated_;
  return PosePrior{predicted, steps * settings_.motion_change_metres,
                   steps * settings_.motion_change_radians};
}

// Behind something large a pose that the motion so far does not lead to is rather the other's than the
// camera's.
bool Tracker::follows_occluder(const Frame& frame, const SE3& predicted) const {
  if (!is_covered(frame) || state_ != TrackingState::tracking || !motion_.known()) return false;
  return (frame.T_cw * predicted.inverse()).translation.norm() > settings_.largest_surprise;
}

// Whether the frame has enough stereo points to begin a map with.
bool Tracker::shows_enough(const Frame& frame) const {
  int points = 0;
  for (int i = 0; i < frame.features->size(); ++i) {
    points += frame.features->has_stereo(i) && !frame.features->is_movable(i);
  }
  return points >= (is_covered(frame) ? settings_.fewest_covered_points : settings_.fewest_initial_points);
}

// Begins a map, or continues one, at the frame's pose: true if it shows enough points with stereo depth.
bool Tracker::start(Frame& frame) {
  if (!shows_enough(frame)) return false;
  state_ = TrackingState::tracking;
  motion_.presume_mean();
  remember(frame);
  return true;
}

// `frame` is located: the next one is compared with it.
void Tracker::remember(Frame& frame) {
  last_.remember(frame);
  previous_T_cw_ = frame.T_cw;
  previous_time_ = frame.timestamp;
  lost_with_view_ = 0;
}

void Tracker::set_keyframe(KeyFrame* keyframe) {
  reference_ = keyframe;
  frames_since_keyframe_ = 0;
  last_.set_keyframe(keyframe);
}

// The map has changed since the last frame: poses were adjusted, points merged or removed.
void Tracker::refresh_map() {
  last_.refresh();
  if (state_ == TrackingState::tracking) previous_T_cw_ = last_.T_cw();
  while (reference_ != nullptr && reference_->erased) reference_ = reference_->stand_in;
  map_.readers_let_go();
}

// First against the last frame that was located, around the predicted pose, then against the map. Where
// either is not clear, a wrong pose may have found itself a few pairs, as on a chessboard: then descriptors
// are asked for another, and the one with which more of the map agrees is taken.
Tracker::Located Tracker::locate_by_prediction(Frame& frame, const SE3& predicted, TrackingReport& report) {
  if (last_.empty()) return {};  // in a map that was loaded nothing came before
  const auto clear = [&](const Located& located) {
    return located.success && is_clear(located.pairs, pairs_) && is_clear(located.inliers, map_inliers_);
  };
  SE3 start = predicted;
  Located located;
  if (motion_.measured()) located = locate_around(frame, start, false, report);
  // What covers the view is rather what descriptors would find then.
  if (!clear(located) && (!prior_ || !motion_.measured())) {
    const Attempt by_motion = attempt(frame, report);
    forget_attempt(frame, report);
    const std::optional<SE3> found = pose_from_descriptors(frame);
    if (found) start = *found;
    Located other;
    if (found || motion_.known()) other = locate_around(frame, start, found && !prior_, report);
    if (other.success && (other.off_map ? !located.success : other.inliers > located.inliers)) {
      located = other;
    } else {
      take(by_motion, frame, report);
    }
  }
  if (!located.success && prior_) {
    forget_attempt(frame, report);
    return locate_by_turning(frame, start, report);
  }
  located.clear = prior_ || located.off_map || clear(located);
  return located;
}

// Whether so many pairs with the last frame, or map points, agree, next to those of the frame before, that no
// other pose will have more.
bool Tracker::is_clear(int inliers, int before) const {
  return inliers > 0 && inliers >= settings_.clear_share * before;
}

// A rough pose where no motion is known, or it has changed: a search around the last pose would find far
// points only, and those fit any small motion. So descriptors are compared without a window, and P3P finds
// the pose in RANSAC.
std::optional<SE3> Tracker::pose_from_descriptors(const Frame& frame) const {
  const std::vector<PoseObservation> observations = last_.match_anywhere(*frame.features);
  PnpRansacSettings ransac;
  ransac.seed = static_cast<std::uint64_t>(frame.index);
  ransac.fewest_inliers =
      is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_frame_inliers;
  const std::optional<PnpResult> pnp = solve_pnp_ransac(map_.camera(), observations, ransac);
  if (!pnp) return std::nullopt;
  return separate_motions(map_.camera(), observations, optimize_pose(map_.camera(), *pnp, observations),
                          std::nullopt, ransac.seed, settings_.rigid_mover)
      .world.T_cw;
}

// The pose around `start` with which most pairs of the last frame agree, first in a narrow window, then in a
// wide one; then the map's. Where the map has too few points here, as after a fast turn, what the last frame
// tells is enough if it tells it clearly and the frame `may_leave_map`: a keyframe then makes the points.
// (Far points alone fit any motion, so only a start that RANSAC has found may.)
Tracker::Located Tracker::locate_around(Frame& frame, const SE3& start, bool may_leave_map,
                                        TrackingReport& report) {
  frame.T_cw = start;
  Located step = locate_from_last_frame(frame, settings_.search_radius, report);
  if (!is_clear(step.pairs, pairs_)) {
    const Attempt narrow = attempt(frame, report);
    forget_attempt(frame, report);
    frame.T_cw = start;
    const Located wide = locate_from_last_frame(frame, settings_.wide_search_radius, report);
    if (wide.pairs > step.pairs) {
      step = wide;
    } else {
      take(narrow, frame, report);
    }
  }
  report.frame_inliers = step.pairs;
  if (!step.success) return {};
  may_leave_map = may_leave_map && settings_.extends_map && step.pairs >= settings_.fewest_step_inliers;
  const Attempt by_last_frame = may_leave_map ? attempt(frame, report) : Attempt();
  Located located = locate_in_local_map(frame);
  located.pairs = step.pairs;
  if (located.success || !may_leave_map) return located;
  take(by_last_frame, frame, report);
  step.inliers = step.pairs;
  step.off_map = true;
  return step;
}

void Tracker::keep(const Frame& frame, const PairsReport& report, Attempt& attempt) const {
  attempt.T_cw = frame.T_cw;
  attempt.points = frame.points;
  attempt.aligned = frame.aligned;
  attempt.keypoints = frame.features->left.keypoints;
  attempt.right_columns = frame.features->u_right;
  attempt.movable = frame.features->movable;
  attempt.pairs = report;
  attempt.loose = loose_;
  attempt.looked_for = looked_for_;
  attempt.reference = reference_;
}

Tracker::Attempt Tracker::attempt(const Frame& frame, const PairsReport& report) const {
  Attempt attempt;
  keep(frame, report, attempt);
  return attempt;
}

void Tracker::take(const Attempt& attempt, Frame& frame, PairsReport& report) {
  frame.T_cw = attempt.T_cw;
  frame.points = attempt.points;
  frame.aligned = attempt.aligned;
  frame.features->left.keypoints = attempt.keypoints;
  frame.features->u_right = attempt.right_columns;
  frame.features->movable = attempt.movable;
  report = attempt.pairs;
  loose_ = attempt.loose;
  looked_for_ = attempt.looked_for;
  reference_ = attempt.reference;
}

// Behind something large a bend may begin or end unseen: the few points that are left are looked for as far
// to the left and right as a turn takes them.
Tracker::Located Tracker::locate_by_turning(Frame& frame, const SE3& start, TrackingReport& report) {
  constexpr int kTurns = 5;
  const double turn = 1.5 * settings_.search_radius / map_.camera().fx;
  int most = 0;
  SE3 best;
  const auto step_from = [&](const SE3& T_cw) {
    forget_attempt(frame, report);
    prior_->T_cw = frame.T_cw = T_cw;
    return locate_from_last_frame(frame, settings_.search_radius, report);
  };
  for (int k = -kTurns; k <= kTurns; ++k) {
    Vector6d motion = Vector6d::Zero();
    motion[4] = k * turn;
    const SE3 turned = SE3::exp(motion) * start;
    const int pairs = step_from(turned).pairs;
    if (pairs <= most) continue;
    most = pairs;
    best = turned;
  }
  if (most == 0) return {};
  report.frame_inliers = step_from(best).pairs;
  Located located = locate_in_local_map(frame);
  located.pairs = most;
  return located;
}

Tracker::Located Tracker::locate_from_last_frame(Frame& frame, float radius, TrackingReport& report) {
  FrameMatcherSettings search;
  search.radius = radius;
  std::vector<Projection> projections;
  std::vector<Match> matches;
  {
    const auto scope = timer_.measure("match_last_frame");
    projections = last_.project(frame.T_cw);
    matches = match_projections(projections, *frame.features, {}, map_.scales(), search);
  }
  {
    const auto scope = timer_.measure("mismatch_filter");
    matches = filter_matches(matches, last_.pixels(matches, projections, *frame.features), report);
  }
  const auto scope = timer_.measure("pose");
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) {
    observations.push_back(
        {*last_.point(match.source), measurement_of(*frame.features, match.feature, map_.scales())});
  }
  const PoseEstimate estimate = leave_out_mover(
      frame, observations, optimize_pose(map_.camera(), frame.T_cw, observations, prior_), report);
  const int fewest = is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_frame_inliers;
  if (estimate.inliers < fewest) return {};
  frame.T_cw = estimate.T_cw;
  std::fill(frame.points.begin(), frame.points.end(), nullptr);
  loose_.clear();
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto [last_feature, feature] = std::pair(matches[m].source, matches[m].feature);
    if (!estimate.inlier[m] || frame.features->is_movable(feature)) continue;
    MapPoint* point = last_.map_point(last_feature);
    frame.points[static_cast<std::size_t>(feature)] = point;
    if (point == nullptr) loose_.push_back(last_.loose_point(feature, last_feature));
  }
  return {true, estimate.inliers};
}

std::vector<Match> Tracker::filter_matches(const std::vector<Match>& matches,
                                           const std::vector<MatchedPixels>& pixels,
                                           TrackingReport& report) const {
  std::vector<char> keep;
  report.frame_matches = static_cast<int>(matches.size());
  report.filter = filter_mismatches(pixels, settings_.mismatch_filter, keep);
  std::vector<Match> kept;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (keep[m]) kept.push_back(matches[m]);
  }
  return kept;
}

// The pose of the world, where `estimate` may be that of something large that moves; features on that are
// marked.
PoseEstimate Tracker::leave_out_mover(Frame& frame, std::span<const PoseObservation> observations,
                                      const PoseEstimate& estimate, TrackingReport& report) const {
  const std::optional<SE3> predicted = motion_.known() ? std::optional<SE3>(frame.T_cw) : std::nullopt;
  SeparatedMotions motions = separate_motions(map_.camera(), observations, estimate, predicted,
                                              static_cast<std::uint64_t>(frame.index), settings_.rigid_mover);
  if (motions.mover) mark_mover(motions, *frame.features);
  report.mover = std::move(motions.mover);
  return std::move(motions.world);
}

// Where the camera was last, best first: this run's newest keyframes; before there are any, the reference and
// its neighbours in a map that was loaded.
std::vector<KeyFrame*> Tracker::keyframes_near() const {
  std::vector<KeyFrame*> near;
  const std::vector<KeyFrame*>& all = map_.keyframes();
  for (auto k = all.rbegin(); k != all.rend() && (*k)->id >= first_own_keyframe_; ++k) {
    if (static_cast<int>(near.size()) == settings_.recognition.last_keyframes) return near;
    near.push_back(*k);
  }
  if (!near.empty() || reference_ == nullptr) return near;
  near.push_back(reference_);
  for (const Covisible& c : reference_->covisibles) near.push_back(c.keyframe);
  return near;
}

// Without a useful prediction: by the place index, then against the map there.
Tracker::Located Tracker::recognise(Frame& frame) {
  {
    const auto scope = timer_.measure("recognise");
    std::optional<VerifiedPlace> found =
        recognise_image(map_, index_, keyframes_near(), *frame.features,
                        static_cast<std::uint64_t>(frame.index), settings_.recognition, frame.objects);
    if (!found) return {};
    frame.T_cw = found->T_cw;
    frame.points = std::move(found->points);
    reference_ = found->keyframe;
  }
  return locate_in_local_map(frame);
}

Tracker::Located Tracker::locate_in_local_map(Frame& frame) {
  const auto scope = timer_.measure("local_map");
  const std::vector<double>& scales = map_.scales();
  const LocalMap local = collect_local_map(frame, reference_, settings_.local_keyframes);
  reference_ = local.reference;
  looked_for_ = match_map_points(map_.camera(), scales, local.points, settings_.map_search_radius, frame);
  const std::vector<PoseObservation> observations = refine_observations(map_.camera(), scales, loose_, frame);
  const PoseEstimate estimate = optimize_pose(map_.camera(), frame.T_cw, observations, prior_);
  const int inliers = keep_agreeing(map_.camera(), scales, observations, estimate, frame);
  const int fewest = is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_map_inliers;
  if (inliers < fewest) return {};
  frame.T_cw = estimate.T_cw;
  Located located{true};
  located.inliers = inliers;
  return located;
}

// How often a point is found where it should be seen decides whether it stays (local_mapper.h).
void Tracker::count_sightings(const Frame& frame) {
  for (MapPoint* point : looked_for_) ++point->visible;
  for (MapPoint* point : frame.points) {
    if (point != nullptr) ++point->found;
  }
}

// Whether the frame becomes the keyframe that is wanted, if one is.
bool Tracker::sharp_enough(const Frame& frame, bool wanted) {
  const bool sharp = frame.pyramid->levels() < 2 || sharpness_.is_sharp(frame.pyramid->level(1));
  if (!wanted) return false;
  const bool takes = sharp || ++blurred_candidates_ > settings_.longest_sharpness_wait;
  if (takes) blurred_candidates_ = 0;
  return takes;
}

void Tracker::finish(Frame& frame, bool located) {
  ++frames_since_keyframe_;
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
    unlocated_ = 0;
    remember(frame);
  } else {
    state_ = is_covered(frame) ? TrackingState::occluded : TrackingState::lost;
    previous_T_cw_ = frame.T_cw;
    previous_time_ = frame.timestamp;
    lost_with_view_ += shows_enough(frame);
    ++unlocated_;
  }
}

}  // namespace penumbra::slam
