#include "slam/frontend/locating/local_map.h"

#include <algorithm>
#include <map>

namespace penumbra::slam {

namespace {

// Keyframes that see the points, most points first, the oldest of equals first.
std::vector<KeyFrame*> keyframes_by_votes(std::span<MapPoint* const> shown) {
  std::map<int, Covisible> votes;
  for (const MapPoint* point : shown) {
    if (point == nullptr) continue;
    for (const Observation& o : point->observations) {
      Covisible& vote = votes[o.keyframe->id];
      vote.keyframe = o.keyframe;
      ++vote.shared_points;
    }
  }
  std::vector<Covisible> ordered;
  for (const auto& [id, vote] : votes) ordered.push_back(vote);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Covisible& a, const Covisible& b) { return a.shared_points > b.shared_points; });
  std::vector<KeyFrame*> keyframes;
  for (const Covisible& vote : ordered) keyframes.push_back(vote.keyframe);
  return keyframes;
}

}  // namespace

LocalMap collect_local_map(std::span<MapPoint* const> shown, KeyFrame* old_reference, int most_keyframes) {
  LocalMap local;
  std::vector<KeyFrame*> keyframes = keyframes_by_votes(shown);
  local.reference = keyframes.empty() ? old_reference : keyframes.front();
  if (local.reference != nullptr) {
    std::vector<KeyFrame*> more = {local.reference};
    for (const Covisible& c : local.reference->covisibles) more.push_back(c.keyframe);
    for (KeyFrame* keyframe : more) {
      if (std::find(keyframes.begin(), keyframes.end(), keyframe) == keyframes.end())
        keyframes.push_back(keyframe);
    }
  }
  if (static_cast<int>(keyframes.size()) > most_keyframes)
    keyframes.resize(static_cast<std::size_t>(most_keyframes));

  for (const KeyFrame* keyframe : keyframes) {
    for (MapPoint* point : keyframe->points) {
      if (point != nullptr) local.points.push_back(point);
    }
  }
  std::sort(local.points.begin(), local.points.end(),
            [](const MapPoint* a, const MapPoint* b) { return a->id < b->id; });
  local.points.erase(std::unique(local.points.begin(), local.points.end()), local.points.end());
  return local;
}

}  // namespace penumbra::slam
