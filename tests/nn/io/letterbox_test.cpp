#include "nn/io/letterbox.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::nn {
namespace {

constexpr float kGrey = 114.0F / 255.0F;

TEST(Letterbox, FramesTheImageUpToTheNextMultipleOfTheStride) {
  Arena arena;
  // 427 x 640 keeps its size; 448 - 427 = 21 columns of frame, 10 on the left.
  const LetterboxedImage tall = letterbox_image(cv::Mat3b(640, 427, {10, 20, 30}), {}, arena, 0);
  EXPECT_EQ(tall.map.width(), 448);
  EXPECT_EQ(tall.map.height(), 640);
  EXPECT_EQ(tall.left, 10);
  EXPECT_EQ(tall.top, 0);
  EXPECT_FLOAT_EQ(tall.map.pixel(0, 0, 0, 9)[0], kGrey);
  EXPECT_FLOAT_EQ(tall.map.pixel(0, 0, 0, 10)[0], 30.0F / 255.0F) << "red first";
  EXPECT_FLOAT_EQ(tall.map.pixel(0, 0, 639, 436)[2], 10.0F / 255.0F);
  EXPECT_FLOAT_EQ(tall.map.pixel(0, 0, 639, 437)[2], kGrey);
  // 1241 x 376 shrinks to 640 x 194, framed to 224 rows.
  const LetterboxedImage wide = letterbox_image(cv::Mat1b(376, 1241, std::uint8_t{51}), {}, arena, 2);
  EXPECT_EQ(wide.width, 640);
  EXPECT_EQ(wide.height, 194);
  EXPECT_EQ(wide.map.height(), 224);
  EXPECT_EQ(wide.top, 15);
  EXPECT_NEAR(wide.scale, 640.0 / 1241.0, 1e-6);
  EXPECT_FLOAT_EQ(wide.map.pixel(0, 0, 15, 0)[1], 0.2F) << "grey images have three equal channels";
  EXPECT_EQ(wide.map.pixel(0, 0, -1, 0)[0], 0.0F) << "the border is zero";
}

TEST(Letterbox, TakesThinImagesAndRefusesEmptyOnes) {
  Arena arena;
  const LetterboxedImage thin = letterbox_image(cv::Mat1b(1, 5000, std::uint8_t{0}), {}, arena, 0);
  EXPECT_EQ(thin.height, 1);
  EXPECT_EQ(thin.map.height(), 32);
  EXPECT_THROW(letterbox_image({}, {}, arena, 0), InputError);
  EXPECT_THROW(letterbox_image(cv::Mat(4, 4, CV_16UC1), {}, arena, 0), InputError);
}

}  // namespace
}  // namespace penumbra::nn
