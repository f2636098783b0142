// Rectangles of many sizes and greys over each other.
#pragma once

#include <cstdint>
#include <vector>

namespace penumbra::test {

inline std::vector<std::uint8_t> texture(int width, int height, int rectangles, std::uint64_t seed) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 128);
  const auto draw = [&seed](int below) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<int>((seed >> 33) % static_cast<std::uint64_t>(below));
  };
  for (int i = 0; i < rectangles; ++i) {
    const int x = draw(width), y = draw(height), w = 3 + draw(12), h = 3 + draw(12), grey = draw(256);
    for (int v = y; v < y + h && v < height; ++v) {
      for (int u = x; u < x + w && u < width; ++u)
        pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)] =
            static_cast<std::uint8_t>(grey);
    }
  }
  return pixels;
}

}  // namespace penumbra::test
