#include "slam/backend/newcomers.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

// The keyframe that a newcomer follows; nullptr where there is none.
const KeyFrame* leader(const KeyFrame& newcomer, const KeyFrame* previous, const PosesBefore& before) {
  for (const Covisible& c : newcomer.covisibles) {
    if (c.keyframe->id < newcomer.id && before.count(c.keyframe) > 0) return c.keyframe;
  }
  const bool follows =
      previous != nullptr && previous->submap == newcomer.submap && before.count(previous) > 0;
  return follows ? previous : nullptr;
}

}  // namespace

void move_newcomers(Map& map, int newest, PosesBefore& before) {
  const std::vector<KeyFrame*>& keyframes = map.keyframes();
  const auto first = std::upper_bound(keyframes.begin(), keyframes.end(), newest,
                                      [](int id, const KeyFrame* keyframe) { return id < keyframe->id; });
  for (auto at = first; at != keyframes.end(); ++at) {
    KeyFrame* keyframe = *at;
    const KeyFrame* leads = leader(*keyframe, at == keyframes.begin() ? nullptr : *(at - 1), before);
    if (leads == nullptr) continue;
    const SE3 T_before = keyframe->T_cw;
    keyframe->T_cw = T_before * before.at(leads).inverse() * leads->T_cw;
    keyframe->T_cw.normalize();
    before[keyframe] = T_before;
    const SE3 moved = keyframe->T_cw.inverse() * T_before;
    for (MapPoint* point : keyframe->points) {
      if (point != nullptr && point->observations.front().keyframe == keyframe)
        point->position = moved * point->position;
    }
  }
}

}  // namespace penumbra::slam
