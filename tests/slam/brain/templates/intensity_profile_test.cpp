#include "slam/brain/templates/intensity_profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

ByteImage random_image(int width, int height, std::uint64_t seed) {
  ByteImage image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image.at(x, y) = static_cast<std::uint8_t>(
          counter_random(seed, static_cast<std::uint64_t>(y / 9 * 1000 + x / 9)) % 256);
  }
  return image;
}

TEST(IntensityProfile, HasMeanZeroAndDeviationOne) {
  const IntensityProfile profile = intensity_profile(random_image(620, 188, 3).view());
  double sum = 0.0, squares = 0.0;
  for (const float field : profile) {
    sum += field;
    squares += field * field;
  }
  EXPECT_NEAR(sum / 600.0, 0.0, 1e-5);
  EXPECT_NEAR(squares / 600.0, 1.0, 1e-4);
}

TEST(IntensityProfile, ForgetsBrightnessAndContrast) {
  const ByteImage image = random_image(620, 188, 4);
  ByteImage darker = image;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x)
      darker.at(x, y) = static_cast<std::uint8_t>(image.at(x, y) / 2 + 20);
  }
  const ProfileDifference difference =
      compare_profiles(intensity_profile(image.view()), intensity_profile(darker.view()), 5);
  EXPECT_LT(difference.difference, 0.02F);
  EXPECT_EQ(difference.shift, 0);
}

TEST(IntensityProfile, AConstantImageIsAllZeros) {
  const ByteImage grey = ByteImage::filled(100, 50, 77);
  for (const float field : intensity_profile(grey.view())) EXPECT_EQ(field, 0.0F);
}

TEST(IntensityProfile, RefusesImagesThatAreTooSmall) {
  const ByteImage small = ByteImage::filled(59, 50, 7);
  EXPECT_THROW(intensity_profile(small.view()), InputError);
}

TEST(CompareProfiles, ByHand) {
  // One field of a is 3, and of b, two columns to the right: the pictures are one where b is shifted by 2.
  IntensityProfile a{}, b{};
  a[3 * kProfileWidth + 20] = 3.0F;
  b[3 * kProfileWidth + 22] = 3.0F;
  const ProfileDifference found = compare_profiles(a, b, 5);
  EXPECT_EQ(found.shift, 2);
  EXPECT_EQ(found.difference, 0.0F);
  // Without shifts both fields differ by 3, of 600.
  EXPECT_NEAR(compare_profiles(a, b, 0).difference, 6.0F / 600.0F, 1e-7);
}

TEST(CompareProfiles, IsTheLeastOfTheNaiveMeans) {
  const IntensityProfile a = intensity_profile(random_image(620, 188, 5).view());
  const IntensityProfile b = intensity_profile(random_image(620, 188, 6).view());
  double least = 1e9;
  for (int shift = -4; shift <= 4; ++shift) {
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < kProfileHeight; ++y) {
      for (int x = 0; x < kProfileWidth; ++x) {
        if (x + shift < 0 || x + shift >= kProfileWidth) continue;
        sum += std::abs(a[static_cast<std::size_t>(y * kProfileWidth + x)] -
                        b[static_cast<std::size_t>(y * kProfileWidth + x + shift)]);
        ++count;
      }
    }
    least = std::min(least, sum / count);
  }
  EXPECT_NEAR(compare_profiles(a, b, 4).difference, least, 1e-5);
}

}  // namespace
}  // namespace penumbra::slam::brain
