#include "tests/support/random_network.h"

#include "nn/base/counter_random.h"

namespace penumbra::test {

ByteImage random_image(std::uint32_t seed, int width, int height) {
  ByteImage image(width, height, 3);
  const int blocks = (width + 7) / 8;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const auto coarse = static_cast<std::uint32_t>((y / 8 * blocks + x / 8) * 3 + c);
        const auto fine = static_cast<std::uint32_t>((y * width + x) * 3 + c);
        const float value = 127.5F + 90.0F * counter_uniform_f32(seed, coarse);
        image.at(x, y, c) = static_cast<std::uint8_t>(value + 30.0F * counter_uniform_f32(seed + 1000, fine));
      }
    }
  }
  return image;
}

}  // namespace penumbra::test
