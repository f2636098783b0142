// A stereo camera, or one with depth, that moves to the right before two textured walls.
#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/slam.h"
#include "tests/library/texture.h"

namespace penumbra::test {

// The upper wall is near, the lower one far.
class Walls {
 public:
  static constexpr int kWidth = 640, kHeight = 240;
  static constexpr double kFocal = 500.0, kBaseline = 0.5;
  static constexpr int kNear = 30, kFar = 10;  // disparities, pixels
  static constexpr int kStep = 6;              // pixels that the near wall moves by a frame

  Walls() : near_(wall(1)), far_(wall(2)) {}

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

  static std::vector<std::uint8_t> wall(std::uint64_t seed) {
    return texture(kTexture, kHeight, 40000, seed);
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
