// A stereo camera, or one with depth, that moves to the right before two textured walls.
#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/slam.h"

namespace penumbra::test {

// The upper wall is near, the lower one far.
class Walls {
 public:
  static constexpr int kWidth = 640, kHeight = 240;
  static constexpr double kFocal = 500.0, kBaseline = 0.5;
  static constexpr int kNear = 30, kFar = 10;  // disparities, pixels
  static constexpr int kStep = 6;              // pixels that the near wall moves by a frame

  Walls() : near_(texture(1)), far_(texture(2)) {}

  static Pinhole camera() { return {kFocal, kFocal, 320.0, 120.0, kWidth, kHeight}; }
  static Rig stereo() { return Rig::stereo(camera(), kBaseline); }
  // Metres to the right after `frame` frames.
  static double way(double frame) { return frame * kStep * kBaseline / kNear; }

  std::vector<std::uint8_t> left(int frame) const { return view(kStep * frame, 0); }
  std::vector<std::uint8_t> right(int frame) const { return view(kStep * frame, 1); }
  static std::vector<std::uint16_t> millimetres() {
    std::vector<std::uint16_t> depth;
    for (int y = 0; y < kHeight; ++y) {
      const double metres = kFocal * kBaseline / (y < kHeight / 2 ? kNear : kFar);
      depth.insert(depth.end(), kWidth, static_cast<std::uint16_t>(1000.0 * metres));
    }
    return depth;
  }
  static ImageRef grey(const std::vector<std::uint8_t>& pixels) {
    return {pixels.data(), kWidth, kHeight, PixelFormat::grey8, 0};
  }

 private:
  static constexpr int kTexture = 4000;

  // Rectangles of many sizes and greys over each other.
  static std::vector<std::uint8_t> texture(std::uint64_t seed) {
    std::vector<std::uint8_t> pixels(std::size_t{kTexture} * kHeight, 128);
    const auto draw = [&seed](int below) {
      seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
      return static_cast<int>((seed >> 33) % static_cast<std::uint64_t>(below));
    };
    for (int i = 0; i < 40000; ++i) {
      const int x = draw(kTexture), y = draw(kHeight), w = 3 + draw(12), h = 3 + draw(12), grey = draw(256);
      for (int v = y; v < y + h && v < kHeight; ++v) {
        for (int u = x; u < x + w && u < kTexture; ++u)
          pixels[static_cast<std::size_t>(v) * kTexture + static_cast<std::size_t>(u)] =
              static_cast<std::uint8_t>(grey);
      }
    }
    return pixels;
  }
  std::vector<std::uint8_t> view(int x, int eye) const {
    std::vector<std::uint8_t> image;
    for (int y = 0; y < kHeight; ++y) {
      const bool is_near = y < kHeight / 2;
      const int begin = 100 + (is_near ? x + eye * kNear : x * kFar / kNear + eye * kFar);
      const std::uint8_t* row = (is_near ? near_ : far_).data() + std::ptrdiff_t{y} * kTexture + begin;
      image.insert(image.end(), row, row + kWidth);
    }
    return image;
  }

  std::vector<std::uint8_t> near_, far_;
};

}  // namespace penumbra::test
