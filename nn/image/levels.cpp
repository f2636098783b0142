#include "nn/image/levels.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

ByteImage upper_bits(const WordImage& levels, int bits) {
  ByteImage bytes(levels.width(), levels.height(), levels.channels());
  const int shift = std::max(0, bits - 8);
  std::transform(
      levels.data(), levels.data() + levels.elements(), bytes.data(),
      [shift](std::uint16_t level) { return static_cast<std::uint8_t>(std::min(level >> shift, 255)); });
  return bytes;
}

FloatImage metres_of(const WordImage& levels, double factor) {
  FloatImage depth(levels.width(), levels.height());
  const auto metres = static_cast<float>(1.0 / factor);  // a level
  std::transform(levels.data(), levels.data() + levels.elements(), depth.data(),
                 [metres](std::uint16_t level) { return static_cast<float>(level) * metres; });
  return depth;
}

FloatImage known_metres(FloatImage depth) {
  for (std::size_t i = 0; i < depth.elements(); ++i) {
    float& metres = depth.data()[i];
    if (!(std::isfinite(metres) && metres > 0.0F)) metres = 0.0F;
  }
  return depth;
}

}  // namespace penumbra
