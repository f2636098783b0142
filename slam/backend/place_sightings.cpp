#include "slam/backend/place_sightings.h"

#include <cmath>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

void PlaceSightings::forget_before(const KeyFrame& newest) {
  while (!sightings_.empty() && newest.id - sightings_.front().keyframe->id >= settings_.window)
    sightings_.pop_front();
}

// Whether odometry says the same about two keyframes as their places do.
bool PlaceSightings::agree(const PlaceSighting& a, const PlaceSighting& b) const {
  const SE3 by_odometry = current_pose(*b.keyframe) * current_pose(*a.keyframe).inverse();
  const SE3 by_place = b.T_cw * a.T_cw.inverse();
  const SE3 difference = by_place * by_odometry.inverse();
  return difference.translation.norm() <= settings_.agree_metres + 0.05 * by_odometry.translation.norm() &&
         difference.angle() <= settings_.agree_radians;
}

// A turn about the direction of view shows the same points, so it does not count.
bool PlaceSightings::are_independent(const PlaceSighting& a, const PlaceSighting& b) const {
  const double way = (camera_centre(a.T_cw) - camera_centre(b.T_cw)).norm();
  const double cosine = a.T_cw.rotation.row(2).dot(b.T_cw.rotation.row(2));
  return way >= settings_.least_motion_baselines * baseline_ || cosine <= std::cos(settings_.least_turn);
}

bool PlaceSightings::agree_with(const PlaceSighting& newest) const {
  int agreeing = 1;
  bool independent = false;
  for (const PlaceSighting& sighting : sightings_) {
    if (sighting.keyframe->submap != newest.keyframe->submap || !agree(sighting, newest)) continue;
    ++agreeing;
    independent = independent || are_independent(sighting, newest);
  }
  return agreeing >= settings_.consistent && independent;
}

KeyFrame* nearest_keyframe(const VerifiedPlace& place, double distance, double turn,
                           const std::function<bool(const KeyFrame&)>& counts) {
  std::vector<KeyFrame*> there = {place.keyframe};
  for (const Covisible& c : place.keyframe->covisibles) there.push_back(c.keyframe);
  KeyFrame* nearest = nullptr;
  for (KeyFrame* k : there) {
    const SE3 between = place.T_cw * k->T_cw.inverse();
    if (between.translation.norm() > distance || between.angle() > turn || !counts(*k)) continue;
    distance = between.translation.norm();
    nearest = k;
  }
  return nearest;
}

}  // namespace penumbra::slam
