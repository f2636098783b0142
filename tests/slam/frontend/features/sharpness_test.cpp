#include "slam/frontend/features/sharpness.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

cv::Mat blurred(const cv::Mat& image, int length) {
  cv::Mat out;
  cv::blur(image, out, cv::Size(length, 1));
  return out;
}

TEST(Tenengrad, OfAStepByHand) {
  // Two columns of a step of 80 have the slope 40; the rest is flat.
  cv::Mat step(20, 100, CV_8U, cv::Scalar(50));
  step.colRange(50, 100) = 130;
  EXPECT_DOUBLE_EQ(tenengrad(test::byte_image(step)), 2.0 * 40.0 * 40.0 / 100.0);
  EXPECT_DOUBLE_EQ(tenengrad(test::byte_image(step), 1700.0), 0.0) << "below the threshold";
  EXPECT_DOUBLE_EQ(tenengrad(ByteImage()), 0.0);
}

TEST(Tenengrad, FallsWithMotionBlur) {
  const cv::Mat image = test::textured_image(320, 240, 3);
  double last = tenengrad(test::byte_image(image), 0.0);
  for (const int length : {3, 7, 15}) {
    const double sharpness = tenengrad(test::byte_image(blurred(image, length)), 0.0);
    EXPECT_LT(sharpness, last) << length;
    last = sharpness;
  }
}

TEST(SharpnessTest, ComparesWithTheImagesBefore) {
  const cv::Mat image = test::textured_image(320, 240, 3);
  SharpnessTest checked(0.6);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(checked.is_sharp(test::byte_image(image)));
  EXPECT_FALSE(checked.is_sharp(test::byte_image(blurred(image, 15))));
  EXPECT_TRUE(checked.is_sharp(test::byte_image(image)));
  // A duller scene is not blurred for ever.
  cv::Mat dull = blurred(image, 15);
  bool sharp = false;
  for (int i = 0; i < 50; ++i) sharp = checked.is_sharp(test::byte_image(dull));
  EXPECT_TRUE(sharp);
}

TEST(SharpnessTest, PassesEverythingWhereItIsOff) {
  SharpnessTest checked(0.0);
  EXPECT_TRUE(checked.is_sharp(test::byte_image(test::textured_image(64, 64, 1))));
  EXPECT_TRUE(checked.is_sharp(ByteImage::filled(64, 64, 0)));
  SharpnessTest on(0.6);
  EXPECT_TRUE(on.is_sharp(ByteImage()));
}

}  // namespace
}  // namespace penumbra::slam
