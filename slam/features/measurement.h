// What a feature of a frame measures, as pose estimation and bundle adjustment take it.
#pragma once

#include <vector>

#include "slam/features/frame_features.h"
#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

// Pixel, right column where there is stereo depth, and 1 / sigma^2 with sigma the pixel size of the feature's
// level
// (`scales`: level_scales of the pyramid).
inline PixelMeasurement measurement_of(const FrameFeatures& features, int feature,
                                       const std::vector<double>& scales) {
  const Keypoint& k = features.keypoint(feature);
  const double sigma = scales[static_cast<std::size_t>(k.level)];
  const float u_right = features.u_right[static_cast<std::size_t>(feature)];
  return {{k.u, k.v, u_right}, 1.0 / (sigma * sigma), u_right >= 0.0F};
}

}  // namespace penumbra::slam
