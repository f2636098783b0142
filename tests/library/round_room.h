// A stereo camera that turns to the right on the spot in a round room with a textured wall.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "penumbra/slam.h"
#include "tests/library/texture.h"

namespace penumbra::test {

class RoundRoom {
 public:
  static constexpr int kWidth = 480, kHeight = 160;
  static constexpr double kFocal = 400.0, kBaseline = 0.5;  // pixels, metres
  static constexpr double kRadius = 8.0;                    // metres

  RoundRoom() : wall_(texture(kAround, kTall, 20000, 3)) {}

  // As if the focal length were `times` the true one: turns are then measured 1 / times as large.
  static Rig rig(double times = 1.0) {
    const double focal = times * kFocal;
    return Rig::stereo({focal, focal, kCentreX, kCentreY, kWidth, kHeight}, kBaseline);
  }
  // Grey pixels after a turn by `yaw` radians; eye 0: left, on the room's axis; 1: right.
  std::vector<std::uint8_t> view(double yaw, int eye) const {
    const double cos = std::cos(yaw), sin = std::sin(yaw);
    const double eye_x = eye * kBaseline * cos, eye_z = -eye * kBaseline * sin;
    std::vector<std::uint8_t> image(std::size_t{kWidth} * kHeight);
    for (int u = 0; u < kWidth; ++u) {
      // The ray eye + t (x, z), whose t is the depth, meets the wall where |eye + t (x, z)| is the radius.
      const double across = (u - kCentreX) / kFocal;
      const double x = across * cos + sin, z = -across * sin + cos;
      const double xx = x * x + z * z, ex = eye_x * x + eye_z * z;
      const double depth =
          (-ex + std::sqrt(ex * ex + xx * (kRadius * kRadius - eye_x * eye_x - eye_z * eye_z))) / xx;
      const double angle = std::atan2(eye_x + depth * x, eye_z + depth * z);
      const double column = kAround * (angle / (2 * std::numbers::pi) + 0.5);
      for (int v = 0; v < kHeight; ++v) {
        const double row = kTall / 2 + kPixelsPerMetre * depth * (v - kCentreY) / kFocal;
        image[static_cast<std::size_t>(v) * kWidth + static_cast<std::size_t>(u)] = wall_at(column, row);
      }
    }
    return image;
  }
  static ImageRef grey(const std::vector<std::uint8_t>& pixels) {
    return {pixels.data(), kWidth, kHeight, PixelFormat::grey8, 0};
  }

 private:
  static constexpr int kAround = 2513, kTall = 200;  // pixels of the wall
  static constexpr double kPixelsPerMetre = kAround / (2 * std::numbers::pi * kRadius);
  static constexpr double kCentreX = 240.0, kCentreY = 80.0;

  // Between the four pixels about it; the wall closes on itself.
  std::uint8_t wall_at(double column, double row) const {
    const double c = std::floor(column), r = std::floor(row), right = column - c, below = row - r;
    const auto pixel = [&](double x, double y) {
      const auto at = (static_cast<std::size_t>(x) + kAround) % kAround;
      return static_cast<double>(wall_[static_cast<std::size_t>(y) * kAround + at]);
    };
    return static_cast<std::uint8_t>((1 - below) * ((1 - right) * pixel(c, r) + right * pixel(c + 1, r)) +
                                     below * ((1 - right) * pixel(c, r + 1) + right * pixel(c + 1, r + 1)) +
                                     0.5);
  }

  std::vector<std::uint8_t> wall_;
};

}  // namespace penumbra::test
