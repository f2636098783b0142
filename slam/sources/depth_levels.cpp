#include "slam/sources/depth_levels.h"

namespace penumbra::slam {

FloatImage metres_of(const WordImage& levels, double factor) {
  FloatImage depth(levels.width(), levels.height());
  const auto metres = static_cast<float>(1.0 / factor);  // a level
  std::transform(levels.data(), levels.data() + levels.elements(), depth.data(),
                 [metres](std::uint16_t level) { return static_cast<float>(level) * metres; });
  return depth;
}

}  // namespace penumbra::slam
