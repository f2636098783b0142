// Images that the tests of nn/image run on, once per instruction set of this machine.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "nn/base/counter_random.h"
#include "nn/image/image.h"
#include "nn/simd/isa.h"

namespace penumbra::test {

// Every value equally likely: what arithmetic must survive.
inline ByteImage noise_image(int width, int height, int channels = 1, std::uint64_t seed = 1) {
  ByteImage image(width, height, channels);
  for (std::size_t i = 0; i < image.elements(); ++i)
    image.data()[i] = static_cast<std::uint8_t>(counter_random(seed, i));
  return image;
}

// Flat squares of random greys with a little noise: corners, edges and empty areas, as cameras see them.
inline ByteImage square_image(int width, int height, std::uint64_t seed = 1) {
  ByteImage image = ByteImage::filled(width, height, 90);
  for (std::uint64_t k = 0; k < 60; ++k) {
    const auto random = [&](int part, int below) {
      return static_cast<int>(counter_random(seed + k, static_cast<std::uint64_t>(part)) %
                              static_cast<std::uint64_t>(below));
    };
    const int x0 = random(0, width), y0 = random(1, height), size = 3 + random(2, 30);
    const auto grey = static_cast<std::uint8_t>(random(3, 256));
    for (int y = y0; y < std::min(height, y0 + size); ++y)
      for (int x = x0; x < std::min(width, x0 + size); ++x) image.at(x, y) = grey;
  }
  for (std::size_t i = 0; i < image.elements(); ++i) {
    const int noisy = image.data()[i] + static_cast<int>(counter_random(seed + 77, i) % 9) - 4;
    image.data()[i] = static_cast<std::uint8_t>(std::clamp(noisy, 0, 255));
  }
  return image;
}

// All values 0 and 255, in random places: the largest differences and sums.
inline ByteImage extreme_image(int width, int height, int channels = 1, std::uint64_t seed = 1) {
  ByteImage image = noise_image(width, height, channels, seed);
  for (std::size_t i = 0; i < image.elements(); ++i) image.data()[i] = image.data()[i] < 128 ? 0 : 255;
  return image;
}

inline ::testing::AssertionResult same_pixels(const ByteImage& a, const ByteImage& b) {
  if (a.size() != b.size() || a.channels() != b.channels())
    return ::testing::AssertionFailure() << "sizes differ: " << a.width() << " x " << a.height() << " and "
                                         << b.width() << " x " << b.height();
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width() * a.channels(); ++x) {
      if (a.row(y)[x] != b.row(y)[x])
        return ::testing::AssertionFailure()
               << "row " << y << " element " << x << ": " << int(a.row(y)[x]) << " and " << int(b.row(y)[x]);
    }
  }
  return ::testing::AssertionSuccess();
}

// A test that runs once per instruction set.
class EveryIsa : public ::testing::TestWithParam<nn::Isa> {
 protected:
  void SetUp() override {
    if (!nn::is_supported(GetParam())) GTEST_SKIP() << "not on this machine";
    nn::use_isa(GetParam());
  }
  void TearDown() override { nn::use_isa(before_); }

 private:
  nn::Isa before_ = nn::current_isa();
};

inline std::string isa_name(const ::testing::TestParamInfo<nn::Isa>& info) { return to_string(info.param); }
inline auto every_isa() { return ::testing::ValuesIn(nn::kKernelIsas); }

}  // namespace penumbra::test
