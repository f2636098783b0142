#include "nn/io/letterbox.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "nn/base/error.h"
#include "nn/image/colour.h"
#include "tests/support/cv_images.h"
#include "tests/support/random_network.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

constexpr float kGrey = 114.0F / 255.0F;

TEST(Letterbox, FramesTheImageUpToTheNextMultipleOfTheStride) {
  Arena arena;
  // 427 x 640 keeps its size; 448 - 427 = 21 columns of frame, 10 on the left.
  ByteImage tall_image(427, 640, 3);
  for (std::size_t i = 0; i < tall_image.elements(); ++i)
    tall_image.data()[i] = static_cast<std::uint8_t>(10 * (i % 3 + 1));
  const LetterboxFrame tall = letterbox_frame(tall_image, {});
  const FeatureMap tall_map = letterbox_image(tall_image, {}, arena, 0);
  EXPECT_EQ(tall_map.width(), 448);
  EXPECT_EQ(tall_map.height(), 640);
  EXPECT_EQ(tall.left, 10);
  EXPECT_EQ(tall.top, 0);
  EXPECT_FLOAT_EQ(tall_map.pixel(0, 0, 0, 9)[0], kGrey);
  EXPECT_FLOAT_EQ(tall_map.pixel(0, 0, 0, 10)[0], 30.0F / 255.0F) << "red first";
  EXPECT_FLOAT_EQ(tall_map.pixel(0, 0, 639, 436)[2], 10.0F / 255.0F);
  EXPECT_FLOAT_EQ(tall_map.pixel(0, 0, 639, 437)[2], kGrey);
  // 1241 x 376 shrinks to 640 x 194, framed to 224 rows.
  const ByteImage wide_image = ByteImage::filled(1241, 376, 51);
  const LetterboxFrame wide = letterbox_frame(wide_image, {});
  const FeatureMap wide_map = letterbox_image(wide_image, {}, arena, 2);
  EXPECT_EQ(wide.width, 640);
  EXPECT_EQ(wide.height, 194);
  EXPECT_EQ(wide_map.height(), 224);
  EXPECT_EQ(wide.top, 15);
  EXPECT_NEAR(wide.scale, 640.0 / 1241.0, 1e-6);
  EXPECT_FLOAT_EQ(wide_map.pixel(0, 0, 15, 0)[1], 0.2F) << "grey images have three equal channels";
  EXPECT_EQ(wide_map.pixel(0, 0, -1, 0)[0], 0.0F) << "the border is zero";
}

TEST(Letterbox, ResizesToTheBytesOfOpenCv) {
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    const int width = test::pick(random, 1, 150), height = test::pick(random, 1, 150);
    ByteImage image = test::random_image(static_cast<std::uint32_t>(round), width, height);
    if (round % 3 == 0) image = with_channels(image, 1);
    Letterbox letterbox;
    letterbox.size = round % 5 == 0 ? std::max(width, height) / 2 + 1 : test::pick(random, 1, 130);
    const LetterboxFrame frame = letterbox_frame(image, letterbox);
    cv::Mat expected;
    cv::resize(test::to_mat(image), expected, {frame.width, frame.height}, 0, 0, cv::INTER_LINEAR);
    Arena arena;
    const FeatureMap map = letterbox_image(image, letterbox, arena, 0);
    int different = 0;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          const int byte = image.channels() == 3 ? 3 * x + 2 - c : x;
          const float value = static_cast<float>(expected.ptr(y)[byte]) / 255.0F;
          different += map.pixel(0, 0, frame.top + y, frame.left + x)[c] != value;
        }
      }
    }
    EXPECT_EQ(different, 0) << width << " x " << height << " to " << frame.width << " x " << frame.height;
  }
}

TEST(Letterbox, TakesThinImagesAndRefusesEmptyOnes) {
  Arena arena;
  const ByteImage thin = ByteImage::filled(5000, 1, 0);
  EXPECT_EQ(letterbox_frame(thin, {}).height, 1);
  EXPECT_EQ(letterbox_image(thin, {}, arena, 0).height(), 32);
  EXPECT_THROW(letterbox_image({}, {}, arena, 0), InputError);
  EXPECT_THROW(letterbox_image(ByteImage::filled(4, 4, 0, 2), {}, arena, 0), InputError);
}

}  // namespace
}  // namespace penumbra::nn
