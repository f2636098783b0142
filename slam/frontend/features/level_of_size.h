// The pyramid level on which a thing is found, from its size: it grows by the factor s from level to level.
//
//   level = log(size) / log(s)       size: in pixels of level 0 a pixel, or a ratio of distances
#pragma once

#include <cmath>
#include <vector>

namespace penumbra::slam {

// log(s); 1 where there is one level only. `scales`: level_scales of the pyramid.
inline double level_step(const std::vector<double>& scales) {
  return scales.size() > 1 ? std::log(scales[1]) : 1.0;
}

// `step`: level_step. Neither rounded nor clamped.
inline double level_of_size(double size, double step) { return std::log(size) / step; }

}  // namespace penumbra::slam
