// Everything that was measured in one stereo frame; shared by all who look at the frame and at its keyframe.
// It never changes: what is found out later is kept beside it (slam/frontend/features/feature_view.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/feature_grid.h"

namespace penumbra::slam {

// Entry i of every vector belongs to feature i of the left image.
struct FrameFeatures {
  Features left;
  std::vector<float> u_right;  // column in the right image, pixels; -1 where there is no stereo match
  std::vector<float> depth;    // metres; -1 where there is no stereo match
  std::vector<std::array<std::uint8_t, 3>> colour;  // blue, green, red of the image, for the map file
  FeatureGrid grid;

  int size() const { return left.size(); }
  const Keypoint& keypoint(int i) const { return left.keypoints[static_cast<std::size_t>(i)]; }
  const Descriptor& descriptor(int i) const { return left.descriptors[static_cast<std::size_t>(i)]; }
  bool has_stereo(int i) const { return u_right[static_cast<std::size_t>(i)] >= 0.0F; }
};

}  // namespace penumbra::slam
