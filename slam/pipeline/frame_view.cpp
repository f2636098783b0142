#include "slam/pipeline/frame_view.h"

namespace penumbra::slam {

FrameView frame_view(const FeatureView& features, const std::vector<MapPoint*>& points,
                     std::vector<InstanceSighting> sightings) {
  FrameView view;
  view.features.reserve(static_cast<std::size_t>(features.size()));
  for (int i = 0; i < features.size(); ++i) {
    const FeaturePixel k = features.pixel(i);
    const auto at = static_cast<std::size_t>(i);
    view.features.push_back({k.u, k.v, at < points.size() && points[at] != nullptr, features.is_movable(i)});
  }
  view.sightings = std::move(sightings);
  return view;
}

}  // namespace penumbra::slam
