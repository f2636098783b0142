#include "slam/frontend/locating/keyframe_choice.h"

#include "slam/map/map.h"

namespace penumbra::slam {

namespace {

// Of the features with close stereo depth, how many show a map point and how many do not.
struct CloseFeatures {
  int mapped = 0, unmapped = 0;
};

CloseFeatures count_close(const FeatureView& features, const std::vector<MapPoint*>& points,
                          double close_depth) {
  CloseFeatures close;
  for (int i = 0; i < features.size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    if (features.depth(i) < 0.0F || features.depth(i) > close_depth || features.is_movable(i)) continue;
    ++(points[at] != nullptr ? close.mapped : close.unmapped);
  }
  return close;
}

}  // namespace

double similarity(const Frame& frame, const KeyFrame& keyframe) {
  int points = 0, shared = 0;
  for (const MapPoint* point : keyframe.points) points += point != nullptr;
  for (const MapPoint* point : frame.points) {
    shared += point != nullptr && observing_feature(*point, keyframe) >= 0;
  }
  return points > 0 ? static_cast<double>(shared) / points : 0.0;
}

bool becomes_keyframe(const Frame& frame, const KeyFrame& most_similar, double seconds_since,
                      const KeyframeSettings& settings) {
  if (seconds_since >= settings.longest_gap_seconds) return true;
  if (similarity(frame, most_similar) < settings.least_similarity) return true;
  const CloseFeatures here = count_close(frame.view(), frame.points, settings.close_depth);
  const CloseFeatures there = count_close(most_similar.view(), most_similar.points, settings.close_depth);
  return here.mapped < settings.least_close_share * there.mapped && here.unmapped > here.mapped;
}

}  // namespace penumbra::slam
