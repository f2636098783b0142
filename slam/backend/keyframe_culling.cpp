#include "slam/backend/keyframe_culling.h"

#include <vector>

namespace penumbra::slam {

bool is_redundant(const KeyFrame& keyframe, double close_depth, const KeyframeCullingSettings& settings) {
  constexpr int kOthers = 3;
  int points = 0, redundant = 0;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const MapPoint* point = keyframe.points[i];
    const float depth = keyframe.features->depth[i];
    if (point == nullptr || depth < 0.0F || depth > close_depth) continue;
    ++points;
    const int level = keyframe.features->keypoint(static_cast<int>(i)).level;
    int others = 0;
    for (const Observation& o : point->observations) {
      others += o.keyframe != &keyframe && o.keyframe->features->keypoint(o.feature).level <= level + 1;
    }
    redundant += others >= kOthers;
  }
  return points > 0 && redundant > settings.redundant_share * points;
}

int cull_redundant_keyframes(Map& map, int submap, double close_depth,
                             const KeyframeCullingSettings& settings) {
  std::vector<KeyFrame*> keyframes;
  for (KeyFrame* keyframe : map.keyframes()) {
    if (keyframe->submap == submap) keyframes.push_back(keyframe);
  }
  int gone = 0;
  for (std::size_t k = keyframes.size(); k-- > 1;) {
    if (!is_redundant(*keyframes[k], close_depth, settings)) continue;
    map.erase_keyframe(keyframes[k]);
    ++gone;
  }
  return gone;
}

}  // namespace penumbra::slam
