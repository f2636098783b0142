#include "slam/backend/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <shared_mutex>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

namespace {

// The keyframe, those covisible with it, and those covisible with these.
std::set<int> ids_around(const KeyFrame& keyframe) {
  std::set<int> ids = {keyframe.id};
  for (const Covisible& near : keyframe.covisibles) {
    ids.insert(near.keyframe->id);
    for (const Covisible& next : near.keyframe->covisibles) ids.insert(next.keyframe->id);
  }
  return ids;
}

}  // namespace

std::optional<ClosedLoop> LoopCloser::process(KeyFrame* keyframe) {
  {
    const std::unique_lock lock(map_.mutex());
    remember_older_keyframes(keyframe);
  }
  std::optional<VerifiedPlace> place;
  if (settings_.enabled) {
    const std::shared_lock lock(map_.mutex());
    place = recognise(*keyframe);
  }
  std::optional<ClosedLoop> closed;
  if (place) {
    const std::unique_lock lock(map_.mutex());
    const PlaceSighting sighting{keyframe, place->T_cw};
    recognised_.push_back({keyframe->frame_index, place->keyframe->frame_index, place->inliers,
                           place->objects, place->keyframe->id < first_own_});
    if (settings_.corrects && keyframe->id - last_loop_ > settings_.pause &&
        sightings_.agree_with(sighting)) {
      close(keyframe, *place);
      closed = loops_.back();
    } else {
      sightings_.add(sighting);
    }
  }
  waiting_.push_back(keyframe);
  return closed;
}

void LoopCloser::adopt_map() {
  const std::unique_lock lock(map_.mutex());
  index_.insert_all(map_);
  for (const KeyFrame* keyframe : map_.keyframes()) measure_way(keyframe);
  first_own_ = static_cast<int>(travelled_.size());
}

void LoopCloser::measure_way(const KeyFrame* newest) {
  const std::size_t id = static_cast<std::size_t>(newest->id);
  if (travelled_.size() <= id) travelled_.resize(id + 1, 0.0);
  if (last_keyframe_ != nullptr) {
    travelled_[id] = travelled_[static_cast<std::size_t>(last_keyframe_->id)] +
                     (camera_centre(newest->T_cw) - camera_centre(current_pose(*last_keyframe_))).norm();
  }
  last_keyframe_ = newest;
}

// Keyframes enter the index when the camera has gone on: the newest would only be found as their own
// neighbours, and many of them are still removed as redundant.
void LoopCloser::remember_older_keyframes(const KeyFrame* newest) {
  index_.remove_erased();
  while (static_cast<int>(waiting_.size()) > settings_.age ||
         (!waiting_.empty() && waiting_.front()->submap != newest->submap)) {
    index_.insert(waiting_.front());
    waiting_.pop_front();
  }
  measure_way(newest);
  sightings_.forget_before(*newest);
}

// The best verified place that is a revisit, if there is one.
std::optional<VerifiedPlace> LoopCloser::recognise(const KeyFrame& keyframe) const {
  const std::set<int> around = ids_around(keyframe);
  const auto excluded = [&](const KeyFrame& other) { return around.count(other.id) > 0; };
  const Constellation objects = constellation_around(keyframe, settings_.verifier.constellation.neighbours);
  std::optional<VerifiedPlace> best;
  for (const PlaceCandidate& candidate : index_.query(keyframe.view(), settings_.candidates, excluded)) {
    std::optional<VerifiedPlace> place =
        verify_place(map_, keyframe.view(), candidate.keyframe,
                     static_cast<std::uint64_t>(keyframe.frame_index), settings_.verifier, objects);
    if (!place || (best && place->inliers <= best->inliers)) continue;
    KeyFrame* nearest = revisited(keyframe, *place);
    if (nearest == nullptr || around.count(nearest->id) > 0) continue;
    place->keyframe = nearest;
    if (drift_explains(keyframe, *place)) best = std::move(place);
  }
  return best;
}

// The keyframe of the place that was nearest to where this one was taken; nullptr where none was near enough
// or it was not long enough ago.
KeyFrame* LoopCloser::revisited(const KeyFrame& keyframe, const VerifiedPlace& place) const {
  return nearest_keyframe(place, settings_.largest_distance, settings_.largest_turn, [&](const KeyFrame& k) {
    return k.submap != keyframe.submap || k.id < first_own_ ||
           keyframe.frame_index - k.frame_index >= settings_.fewest_frames_apart;
  });
}

bool LoopCloser::drift_explains(const KeyFrame& keyframe, const VerifiedPlace& place) const {
  // Between sub-maps nothing is known.
  if (keyframe.submap != place.keyframe->submap) return true;
  const double way = travelled_[static_cast<std::size_t>(keyframe.id)] -
                     travelled_[static_cast<std::size_t>(place.keyframe->id)];
  const double moved = (camera_centre(keyframe.T_cw) - camera_centre(place.T_cw)).norm();
  return moved <= settings_.drift_metres + settings_.drift_share * std::max(way, 0.0);
}

void LoopCloser::close(KeyFrame* keyframe, const VerifiedPlace& place) {
  ClosedLoop loop;
  loop.frame = keyframe->frame_index;
  loop.earlier_frame = place.keyframe->frame_index;
  loop.inliers = place.inliers;
  loop.objects = place.objects;
  loop.of_loaded_map = place.keyframe->id < first_own_;
  loop.correction_metres = (camera_centre(keyframe->T_cw) - camera_centre(place.T_cw)).norm();
  const MapCorrection correction = correct_map(map_, keyframe, place, edges_, settings_.correction);
  loop.merged_submaps = correction.merged_submaps;
  edges_.push_back({keyframe, place.keyframe, place.inliers});
  sightings_.clear();
  last_loop_ = keyframe->id;
  loops_.push_back(loop);
}

}  // namespace penumbra::slam
