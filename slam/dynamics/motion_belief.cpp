#include "slam/dynamics/motion_belief.h"

#include <algorithm>
#include <cmath>

#include "slam/dynamics/movable.h"

namespace penumbra::slam {

namespace {

// Evidence of one frame; the frames' displacements overlap, so one alone must not decide.
constexpr double kLeastEvidence = -1.0, kMostEvidence = 3.0;
constexpr double kLargestLogOdds = 6.0;
constexpr double kMoverLogOdds = 1.0;  // of what seems to move, without a mask, before its motion is measured
// How long a displacement must and may take, as a share of the longest look.
constexpr double kLeastLookShare = 0.15, kMostLookShare = 2.0;

}  // namespace

TrackedInstance MotionBelief::prior(const std::string& class_name) const {
  TrackedInstance instance;
  instance.log_odds = moving_prior(class_name);
  instance.measured = !settings_.check_motion;
  return instance;
}

void MotionBelief::rename(TrackedInstance& instance, const std::string& class_name) const {
  if (!instance.class_name.empty())
    instance.log_odds += moving_prior(class_name) - moving_prior(instance.class_name);
  instance.class_name = class_name;
  instance.can_move = is_movable_class(class_name);
}

void MotionBelief::presume_moving(TrackedInstance& instance) const {
  instance.log_odds = std::max(instance.log_odds, kMoverLogOdds);
  instance.can_move = true;
}

void MotionBelief::take_over(TrackedInstance& part, const TrackedInstance& whole) const {
  part.part = true;
  part.log_odds = whole.log_odds;
  part.measured = whole.measured;
  part.velocity = whole.velocity;
}

void MotionBelief::hear(TrackedInstance& instance, bool moves) const {
  if (moves) {
    presume_moving(instance);
  } else if (!settings_.check_motion) {
    instance.log_odds = moving_prior(instance.class_name);
  }
}

PointOrigin MotionBelief::origin_of(const FrameRecord& at, int feature) const {
  return point_origin(camera_, scales_, at.view(), feature, at.T_co, at.time, settings_.motion);
}

std::vector<PointOrigin> MotionBelief::origins_of(const InstanceView& view, const FrameRecord& at) const {
  std::vector<PointOrigin> origins;
  for (const int feature : view.features) origins.push_back(origin_of(at, feature));
  return origins;
}

bool MotionBelief::learn(TrackedInstance& instance, const std::vector<PointOrigin>& origins,
                         const InstanceView& view, const FrameRecord& at) const {
  if (!at.reliable) return false;
  std::vector<PointDisplacement> displacements;
  for (std::size_t n = 0; n < view.features.size(); ++n) {
    if (!origins[n].known) continue;
    const PointOrigin now = origin_of(at, view.features[n]);
    const double seconds = now.time - origins[n].time;
    const double watched = std::abs(seconds) / settings_.longest_look;
    if (!now.known || !(watched >= kLeastLookShare && watched <= kMostLookShare)) continue;
    displacements.push_back(
        {now.position - origins[n].position, now.covariance + origins[n].covariance, seconds});
  }
  const std::optional<ObjectVelocity> velocity = estimate_velocity(displacements, settings_.motion);
  if (!velocity) return false;
  instance.velocity = velocity->metres_per_second;
  if (!settings_.check_motion) return true;
  const double evidence =
      std::clamp(moving_evidence(*velocity, settings_.motion), kLeastEvidence, kMostEvidence);
  instance.log_odds = std::clamp(instance.log_odds + evidence, -kLargestLogOdds, kLargestLogOdds);
  instance.measured = true;
  instance.part = false;
  return true;
}

void MotionBelief::measure(Track& track, const FrameRecord& at, bool learns) const {
  const InstanceView& view = track.views.back();
  if (learns && learn(track.instance, track.origins, view, at) && track.moves()) {
    // What was found without a mask is not found again while it is followed.
    if (track.instance.class_name.empty()) track.carried = 0;
    if (settings_.check_motion) track.missed = 0;
  }
  for (std::size_t n = 0; n < view.features.size(); ++n) {
    PointOrigin& origin = track.origins[n];
    if (!at.reliable || !origin.known || std::abs(at.time - origin.time) > settings_.longest_look)
      origin = origin_of(at, view.features[n]);
  }
}

bool MotionBelief::stands(const TrackedInstance& instance) const {
  return !instance.can_move || (instance.measured && instance.log_odds <= settings_.standing_log_odds);
}

}  // namespace penumbra::slam
