#include "slam/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include "slam/features/descriptor_matcher.h"
#include "slam/features/measurement.h"
#include "slam/geometry/pnp_ransac.h"
#include "slam/map/projection.h"
#include "slam/tracking/feature_refiner.h"
#include "slam/tracking/local_map.h"

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

  refresh_last_frame();
  const SE3 predicted = this->predicted(frame.timestamp);
  prior_ = expectation(frame, predicted);
  Located located = locate_by_prediction(frame, predicted, report);
  if (!located.success || located.off_map || !located.clear) {
    const Step step{frame.T_cw, frame.points, located.inliers, unmapped_};
    prior_.reset();
    Located recognised = recognise(frame);
    if (recognised.success) recognised = locate_in_local_map(frame);
    if (recognised.success && (located.off_map || recognised.inliers > located.inliers)) {
      located = recognised;
    } else if (located.success) {
      take_step(frame, step);
      if (!located.off_map) located = locate_in_local_map(frame);
    }
  }
  if (located.success && follows_occluder(frame, predicted)) located = {};
  report.map_inliers = located.inliers;
  report.off_map = located.success && located.off_map;
  report.recovered = located.success && (state_ == TrackingState::lost || state_ == TrackingState::occluded);
  if (!located.success) {
    frame.T_cw = predicted;
    std::fill(frame.points.begin(), frame.points.end(), nullptr);
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
  frame.patches = std::make_shared<const std::vector<Patch>>(
      extract_patches(*frame.pyramid, frame.features->left.keypoints));
  last_ = frame;
  last_keyframe_ = nullptr;
  previous_T_cw_ = frame.T_cw;
  previous_time_ = frame.timestamp;
  lost_with_view_ = 0;
}

void Tracker::set_keyframe(KeyFrame* keyframe) {
  reference_ = keyframe;
  frames_since_keyframe_ = 0;
  last_keyframe_ = keyframe;
  last_.reference = keyframe;
  last_.T_c_reference = SE3{};
}

// The map has changed since the last frame: poses were adjusted, points merged or removed.
void Tracker::refresh_last_frame() {
  if (last_.reference != nullptr) last_.T_cw = last_.T_c_reference * current_pose(*last_.reference);
  if (state_ == TrackingState::tracking) previous_T_cw_ = last_.T_cw;
  // The mapper has made points of the frame's features.
  if (last_keyframe_ != nullptr && !last_keyframe_->erased) {
    last_.points = last_keyframe_->points;
  }
  for (MapPoint*& point : last_.points) point = present(point);
  while (reference_ != nullptr && reference_->erased) reference_ = reference_->stand_in;
  map_.readers_let_go();
}

// Every feature of the last frame whose place in space is known, on the level on which its size by now puts
// it.
std::vector<Projection> Tracker::project_last_frame(const SE3& T_cw) const {
  const FrameFeatures& features = *last_.features;
  const int highest = static_cast<int>(map_.scales().size()) - 1;
  const double step = highest > 0 ? std::log(map_.scales()[1]) : 1.0;
  std::vector<Projection> projections;
  for (int i = 0; i < features.size(); ++i) {
    const std::optional<Eigen::Vector3d> point = last_point(i);
    if (!point) continue;
    const Eigen::Vector3d p = T_cw * *point;
    if (!(p.z() > 0.0)) continue;
    const Keypoint& k = features.keypoint(i);
    const Eigen::Vector3d pixel = camera_.project_stereo(p);
    if (!camera_.in_image(pixel.head<2>())) continue;
    const double nearer = (last_.T_cw * *point).norm() / p.norm();
    const int level =
        std::clamp(k.level + static_cast<int>(std::lround(std::log(nearer) / step)), 0, highest);
    projections.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                           static_cast<float>(pixel.z()), level, k.angle, &features.descriptor(i), i});
  }
  return projections;
}

std::vector<Match> Tracker::filter_matches(const std::vector<Match>& matches, const Frame& frame,
                                           TrackingReport& report) const {
  std::vector<MatchedPixels> pairs;
  for (const Match& match : matches) {
    const Keypoint& a = last_.features->keypoint(match.source);
    const Keypoint& b = frame.features->keypoint(match.feature);
    pairs.push_back({{a.u, a.v}, {b.u, b.v}});
  }
  std::vector<char> keep;
  report.frame_matches = static_cast<int>(matches.size());
  report.filter = filter_mismatches(pairs, settings_.mismatch_filter, keep);
  std::vector<Match> kept;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (keep[m]) kept.push_back(matches[m]);
  }
  return kept;
}

// Where a feature of the last frame is in the world, from the map or from its own stereo depth; nothing where
// neither knows.
std::optional<Eigen::Vector3d> Tracker::last_point(int i) const {
  const std::size_t at = static_cast<std::size_t>(i);
  if (last_.features->is_movable(i)) return std::nullopt;
  if (last_.points[at] != nullptr) return last_.points[at]->position;
  if (!last_.features->has_stereo(i)) return std::nullopt;
  const Keypoint& k = last_.features->keypoint(i);
  return last_.T_cw.inverse() * camera_.back_project(k.u, k.v, last_.features->depth[at]);
}

// A rough pose where no motion is known, or it has changed: a search around the last pose would find far
// points only, and those fit any small motion. So descriptors are compared without a window, and P3P finds
// the pose in RANSAC.
std::optional<SE3> Tracker::pose_from_last_frame(const Frame& frame) const {
  std::vector<PoseObservation> observations;
  for (const Match& match :
       match_descriptors(last_.features->left.descriptors, frame.features->left.descriptors, {})) {
    const std::optional<Eigen::Vector3d> point = last_point(match.source);
    if (!point || frame.features->is_movable(match.feature)) continue;
    observations.push_back({*point, measurement_of(*frame.features, match.feature, map_.scales())});
  }
  PnpRansacSettings ransac;
  ransac.seed = static_cast<std::uint64_t>(frame.index);
  ransac.fewest_inliers =
      is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_frame_inliers;
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera_, observations, ransac);
  if (!pnp) return std::nullopt;
  return separate_motions(camera_, observations, optimize_pose(camera_, *pnp, observations), std::nullopt,
                          ransac.seed, settings_.rigid_mover)
      .world.T_cw;
}

// Whether so many pairs with the last frame, or map points, agree, next to those of the frame before, that no
// other pose will have more.
bool Tracker::is_clear(int inliers, int before) const {
  return inliers > 0 && inliers >= settings_.clear_share * before;
}

// The pose around `start` with which most pairs of the last frame agree, first in a narrow window, then in a
// wide one; no inliers where none does.
Tracker::Step Tracker::step_around(Frame& frame, const SE3& start, TrackingReport& report) {
  Step best;
  for (const float radius : {settings_.search_radius, settings_.wide_search_radius}) {
    frame.T_cw = start;
    const Located located = locate_from_last_frame(frame, radius, report);
    if (located.success && located.inliers > best.inliers) {
      best = {frame.T_cw, frame.points, located.inliers, unmapped_};
    }
    if (is_clear(best.inliers, step_inliers_)) break;
  }
  report.frame_inliers = best.inliers;
  return best;
}

// First against the last frame that was located, around the predicted pose, then against the map. Where
// either is not clear, a wrong pose may have found itself a few pairs, as on a chessboard: then descriptors
// are asked for another, and the one with which more of the map agrees is taken. Where the map has too few
// points here, as after a fast turn, what the last frame tells is enough if it tells it clearly: a keyframe
// then makes the points.
Tracker::Located Tracker::locate_by_prediction(Frame& frame, const SE3& predicted, TrackingReport& report) {
  if (last_.features == nullptr) return {};  // in a map that was loaded nothing came before
  corners_ = frame.features->left.keypoints;
  right_columns_ = frame.features->u_right;
  const auto locate = [&](const Step& step) {
    if (step.inliers == 0) return Located{};
    take_step(frame, step);
    return locate_in_local_map(frame);
  };
  Step near;
  if (motion_.measured()) near = step_around(frame, predicted, report);
  Located located = locate(near);
  const auto clear = [&](const Step& step) {
    return located.success && is_clear(step.inliers, step_inliers_) &&
           is_clear(located.inliers, map_inliers_);
  };
  Step best = near, by_descriptors;  // far points alone fit any motion: only RANSAC's may be a step
  SE3 start = predicted;
  // What covers the view is rather what descriptors would find then.
  if (!clear(near) && (!prior_ || !motion_.measured())) {
    const std::optional<SE3> found = pose_from_last_frame(frame);
    if (found) start = *found;
    if (found || motion_.known()) {
      const Step step = step_around(frame, start, report);
      if (found) by_descriptors = step;
      const Located other = locate(step);
      if (other.success && other.inliers > located.inliers) {
        located = other;
        best = step;
      } else {
        located = locate(near);
      }
    }
  }
  if (located.success) {
    located.clear = prior_ || clear(best);
    step_inliers_ = best.inliers;
    map_inliers_ = located.inliers;
    return located;
  }
  if (prior_) return locate_by_turning(frame, start, report);
  if (!settings_.extends_map || by_descriptors.inliers < settings_.fewest_step_inliers) return {};
  take_step(frame, by_descriptors);
  step_inliers_ = by_descriptors.inliers;
  map_inliers_ = 0;
  return {true, by_descriptors.inliers, true};
}

void Tracker::take_step(Frame& frame, const Step& step) {
  frame.features->left.keypoints = corners_;  // another attempt may have moved them
  frame.features->u_right = right_columns_;
  frame.T_cw = step.T_cw;
  frame.points = step.points;
  unmapped_ = step.unmapped;
  std::fill(frame.aligned.begin(), frame.aligned.end(), 0);
}

// Behind something large a bend may begin or end unseen: the few points that are left are looked for as far
// to the left and right as a turn takes them.
Tracker::Located Tracker::locate_by_turning(Frame& frame, const SE3& start, TrackingReport& report) {
  constexpr int kTurns = 5;
  const double turn = 1.5 * settings_.search_radius / camera_.fx;
  int most = 0;
  SE3 best;
  const auto locate = [&](const SE3& T_cw) {
    prior_->T_cw = frame.T_cw = T_cw;
    return locate_from_last_frame(frame, settings_.search_radius, report);
  };
  for (int k = -kTurns; k <= kTurns; ++k) {
    Vector6d motion = Vector6d::Zero();
    motion[4] = k * turn;
    const SE3 turned = SE3::exp(motion) * start;
    const Located located = locate(turned);
    if (!located.success || located.inliers <= most) continue;
    most = located.inliers;
    best = turned;
  }
  if (most == 0) return {};
  report.frame_inliers = locate(best).inliers;
  return locate_in_local_map(frame);
}

Tracker::Located Tracker::locate_from_last_frame(Frame& frame, float radius, TrackingReport& report) {
  FrameMatcherSettings search;
  search.radius = radius;
  std::vector<Match> matches;
  {
    const auto scope = timer_.measure("match_last_frame");
    matches = match_projections(project_last_frame(frame.T_cw), *frame.features, {}, map_.scales(), search);
  }
  {
    const auto scope = timer_.measure("mismatch_filter");
    matches = filter_matches(matches, frame, report);
  }
  const auto scope = timer_.measure("pose");
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) {
    observations.push_back(
        {*last_point(match.source), measurement_of(*frame.features, match.feature, map_.scales())});
  }
  const PoseEstimate estimate =
      leave_out_mover(frame, observations, optimize_pose(camera_, frame.T_cw, observations, prior_), report);
  const int fewest = is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_frame_inliers;
  if (estimate.inliers < fewest) return {false, estimate.inliers};
  frame.T_cw = estimate.T_cw;
  std::fill(frame.points.begin(), frame.points.end(), nullptr);
  unmapped_.clear();
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (!estimate.inlier[m] || frame.features->is_movable(matches[m].feature)) continue;
    MapPoint* point = last_.points[static_cast<std::size_t>(matches[m].source)];
    frame.points[static_cast<std::size_t>(matches[m].feature)] = point;
    if (point == nullptr) {
      unmapped_.push_back({matches[m].feature, matches[m].source, observations[m].point});
    }
  }
  return {true, estimate.inliers};
}

// The pose of the world, where `estimate` may be that of something large that moves; features on that are
// marked.
PoseEstimate Tracker::leave_out_mover(Frame& frame, std::span<const PoseObservation> observations,
                                      const PoseEstimate& estimate, TrackingReport& report) const {
  const std::optional<SE3> predicted = motion_.known() ? std::optional<SE3>(frame.T_cw) : std::nullopt;
  SeparatedMotions motions = separate_motions(camera_, observations, estimate, predicted,
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

// Without a useful prediction.
Tracker::Located Tracker::recognise(Frame& frame) {
  const auto scope = timer_.measure("recognise");
  unmapped_.clear();
  std::optional<VerifiedPlace> found =
      recognise_image(camera_, map_, index_, keyframes_near(), *frame.features,
                      static_cast<std::uint64_t>(frame.index), settings_.recognition);
  if (!found) return {};
  frame.T_cw = found->T_cw;
  frame.points = std::move(found->points);
  reference_ = found->keyframe;
  return {true, found->inliers};
}

Tracker::Located Tracker::locate_in_local_map(Frame& frame) {
  const auto scope = timer_.measure("local_map");
  const LocalMap local = collect_local_map(frame, reference_, settings_.local_keyframes);
  reference_ = local.reference;
  match_local_points(frame, local.points);
  const std::vector<PoseObservation> observations = refine_observations(frame);
  const PoseEstimate estimate = optimize_pose(camera_, frame.T_cw, observations, prior_);
  const int inliers = keep_agreeing(frame, observations, estimate);
  const int fewest = is_covered(frame) ? settings_.fewest_occluded_inliers : settings_.fewest_map_inliers;
  if (inliers < fewest) return {false, inliers};
  frame.T_cw = estimate.T_cw;
  for (MapPoint* point : frame.points) {
    if (point != nullptr && settings_.extends_map) ++point->found;
  }
  return {true, inliers};
}

// Looks for those of `points` that the frame does not show yet, around where they project.
void Tracker::match_local_points(Frame& frame, const std::vector<MapPoint*>& points) const {
  std::vector<const MapPoint*> matched;
  std::vector<char> taken(frame.points.size(), 0);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.points[i] == nullptr) continue;
    taken[i] = 1;
    frame.points[i]->visible += settings_.extends_map;
    matched.push_back(frame.points[i]);
  }
  std::sort(matched.begin(), matched.end());

  std::vector<Projection> projections;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::binary_search(matched.begin(), matched.end(), points[i])) continue;
    std::optional<Projection> projection = project_point(camera_, frame.T_cw, *points[i], map_.scales());
    if (!projection) continue;
    points[i]->visible += settings_.extends_map;
    projection->source = static_cast<int>(i);
    projections.push_back(*projection);
  }
  FrameMatcherSettings search;
  search.radius = settings_.map_search_radius;
  search.ratio = 0.8F;
  search.check_rotation = false;
  for (const Match& match : match_projections(projections, *frame.features, taken, map_.scales(), search)) {
    frame.points[static_cast<std::size_t>(match.feature)] = points[static_cast<std::size_t>(match.source)];
  }
}

// Moves the matched features to where their points' patches are found. What they measure then: first those of
// map points, in the order of the features, then those that are known from the last frame only. Far points
// hold the rotation, also those that are in no map yet.
std::vector<PoseObservation> Tracker::refine_observations(Frame& frame) const {
  const FeatureRefiner refiner(*frame.pyramid, map_.scales());
  const auto refine = [&](int feature, const Eigen::Vector3d& point, const Patch& patch, double patch_depth) {
    const Eigen::Vector3d p = frame.T_cw * point;
    if (!(p.z() > 0.0)) return false;
    return refiner.refine(*frame.features, feature, patch, patch_depth, camera_.project(p), p.z());
  };
  std::vector<PoseObservation> observations;
  const auto observe = [&](int feature, const Eigen::Vector3d& point, bool aligned) {
    observations.push_back({point, measurement_of(*frame.features, feature, map_.scales(), aligned)});
  };
  for (int i = 0; i < frame.features->size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const MapPoint* point = frame.points[at];
    if (point == nullptr) continue;
    frame.aligned[at] = refine(i, point->position, point->patch, point->patch_depth);
    observe(i, point->position, frame.aligned[at]);
  }
  for (const Unmapped& u : unmapped_) {
    if (frame.points[static_cast<std::size_t>(u.feature)] != nullptr) continue;
    const std::size_t last = static_cast<std::size_t>(u.last_feature);
    observe(u.feature, u.point,
            refine(u.feature, u.point, (*last_.patches)[last], last_.features->depth[last]));
  }
  return observations;
}

// Lets go of the points that do not agree with the pose; returns how many stay. An aligned feature that
// misses its narrow gate may still show the point as well as a corner does.
int Tracker::keep_agreeing(Frame& frame, std::span<const PoseObservation> observations,
                           const PoseEstimate& estimate) const {
  int kept = 0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.points[i] == nullptr) continue;
    bool agrees = estimate.inlier[k];
    if (!agrees && frame.aligned[i]) {
      frame.aligned[i] = 0;
      const PixelMeasurement z = measurement_of(*frame.features, static_cast<int>(i), map_.scales());
      const Eigen::Vector3d p = estimate.T_cw * observations[k].point;
      agrees =
          p.z() > 0.0 && reprojection_error(camera_, p, z).squaredNorm() * z.inverse_variance <= z.gate();
    }
    ++k;
    if (agrees) {
      ++kept;
    } else {
      frame.points[i] = nullptr;
    }
  }
  return kept;
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
      motion_.observe(frame.T_cw, last_.T_cw, last_.timestamp, frame.timestamp);
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
