// What the semantics tell the map of its keyframes.
#pragma once

#include <vector>

#include "slam/map/keyframe.h"

namespace penumbra::slam {

// Features of a keyframe that turned out to lie on something that moves.
struct MovingFeatures {
  KeyFrame* keyframe = nullptr;
  std::vector<int> features;
};

// The objects that a keyframe shows, as far as they are known by now; replaces what was told before.
struct KeyframeObjects {
  KeyFrame* keyframe = nullptr;
  std::vector<SeenObject> objects;
};

}  // namespace penumbra::slam
