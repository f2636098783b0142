// What a frame showed, for pictures: its features and the objects that were seen.
#pragma once

#include <memory>
#include <vector>

#include "slam/dynamics/track.h"
#include "slam/frontend/features/feature_view.h"
#include "slam/map/map_point.h"

namespace penumbra::slam {

struct FrameView {
  struct Feature {
    float u = 0.0F, v = 0.0F;  // pixels of the left image
    bool in_map = false;       // shows a map point
    bool movable = false;      // on something that moves
  };
  std::vector<Feature> features;
  std::vector<InstanceSighting> sightings;
};

// `points`: per feature the map point that it shows, or nullptr; empty where none is known.
FrameView frame_view(const FeatureView& features, const std::vector<MapPoint*>& points,
                     std::vector<InstanceSighting> sightings);

}  // namespace penumbra::slam
