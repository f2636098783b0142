// What the semantics tell the map.
#pragma once

#include <vector>

#include "slam/map/keyframe.h"

namespace penumbra::slam {

// Features of a keyframe that turned out to lie on something that moves.
struct MovingFeatures {
  KeyFrame* keyframe = nullptr;
  std::vector<int> features;
};

}  // namespace penumbra::slam
