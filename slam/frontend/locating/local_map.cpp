#include "slam/frontend/locating/local_map.h"

#include <algorithm>
#include <utility>

namespace penumbra::slam {

const LocalMap& LocalMapCollector::collect(std::span<MapPoint* const> shown, KeyFrame* old_reference,
                                           int most_keyframes) {
  local_.reference = old_reference;
  choose_keyframes(shown, static_cast<std::size_t>(std::max(0, most_keyframes)));
  collect_points();
  return local_;
}

// Those that see the points, most points first, the oldest of equals first; then the first one's neighbours.
void LocalMapCollector::choose_keyframes(std::span<MapPoint* const> shown, std::size_t most) {
  votes_.clear();
  for (const MapPoint* point : shown) {
    if (point == nullptr) continue;
    for (const Observation& o : point->observations) ++votes_[o.keyframe];
  }
  votes_.sort_by_value();
  keyframes_.clear();
  for (const KeyframeTable::Entry& vote : votes_.entries()) keyframes_.push_back(vote.keyframe);
  if (!keyframes_.empty()) local_.reference = keyframes_.front();
  const auto add = [&](KeyFrame* keyframe) {
    if (std::find(keyframes_.begin(), keyframes_.end(), keyframe) == keyframes_.end())
      keyframes_.push_back(keyframe);
  };
  if (local_.reference != nullptr && keyframes_.size() < most) {
    add(local_.reference);
    for (const Covisible& c : local_.reference->covisibles) add(c.keyframe);
  }
  keyframes_.resize(std::min(keyframes_.size(), most));
}

// All that they see, each once, in the order of their ids.
void LocalMapCollector::collect_points() {
  if (++collection_ == 0) {  // the count has run over
    std::fill(seen_in_.begin(), seen_in_.end(), 0);
    collection_ = 1;
  }
  points_.clear();
  for (const KeyFrame* keyframe : keyframes_) {
    for (MapPoint* point : keyframe->points) {
      if (point == nullptr) continue;
      const auto id = static_cast<std::size_t>(point->id);
      if (seen_in_.size() <= id) seen_in_.resize(std::max(id + 1, 2 * seen_in_.size()), 0);
      if (std::exchange(seen_in_[id], collection_) != collection_) points_.push_back({point->id, point});
    }
  }
  std::sort(points_.begin(), points_.end(),
            [](const NumberedPoint& a, const NumberedPoint& b) { return a.id < b.id; });
  local_.points.clear();
  for (const NumberedPoint& numbered : points_) local_.points.push_back(numbered.point);
}

}  // namespace penumbra::slam
