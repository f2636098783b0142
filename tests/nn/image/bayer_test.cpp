#include "nn/image/bayer.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "nn/image/yuv422.h"
#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

TEST(Bayer, InsideTheBorderTheBitsAreThoseOfOpenCv) {
  const struct {
    BayerPattern pattern;
    int code;  // OpenCV names the second row's second and third pixel
  } cases[] = {{BayerPattern::rggb, cv::COLOR_BayerBG2BGR},
               {BayerPattern::bggr, cv::COLOR_BayerRG2BGR},
               {BayerPattern::gbrg, cv::COLOR_BayerGR2BGR},
               {BayerPattern::grbg, cv::COLOR_BayerGB2BGR}};
  for (const auto& [pattern, code] : cases) {
    for (const Size size : {Size{40, 30}, {33, 21}, {64, 5}}) {
      const ByteImage mosaic = test::noise_image(size.width, size.height, 1);
      const ByteImage bgr = demosaic(mosaic, pattern);
      cv::Mat oracle;
      cv::cvtColor(test::to_mat(mosaic), oracle, code);
      for (int y = 1; y + 1 < size.height; ++y) {
        for (int x = 1; x + 1 < size.width; ++x) {
          for (int c = 0; c < 3; ++c)
            ASSERT_EQ(bgr.at(x, y, c), oracle.at<cv::Vec3b>(y, x)[c])
                << code << " " << x << " " << y << " " << c;
        }
      }
    }
  }
}

// A picture of one colour gives that colour everywhere, also along the border and in the smallest mosaic.
TEST(Bayer, OneColourStaysOneColour) {
  const std::uint8_t blue = 10, green = 100, red = 200;
  for (const Size size : {Size{2, 2}, {7, 4}, {2, 9}}) {
    ByteImage mosaic(size.width, size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x)
        mosaic.at(x, y) = (x + y) % 2 == 1 ? green : y % 2 == 0 ? red : blue;
    }
    const ByteImage bgr = demosaic(mosaic, BayerPattern::rggb);
    for (std::size_t i = 0; i < bgr.elements(); i += 3) {
      EXPECT_EQ(bgr.data()[i], blue);
      EXPECT_EQ(bgr.data()[i + 1], green);
      EXPECT_EQ(bgr.data()[i + 2], red);
    }
  }
}

TEST(Yuv422, ColoursAreThoseOfOpenCvWithinOneLevel) {
  const ByteImage pairs = test::noise_image(64, 20, 2);
  for (const auto& [order, colour, grey] :
       {std::tuple(Yuv422Order::uyvy, cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2GRAY_UYVY),
        std::tuple(Yuv422Order::yuyv, cv::COLOR_YUV2BGR_YUY2, cv::COLOR_YUV2GRAY_YUY2)}) {
    cv::Mat oracle, oracle_grey, difference;
    cv::cvtColor(test::to_mat(pairs), oracle, colour);
    cv::cvtColor(test::to_mat(pairs), oracle_grey, grey);
    cv::absdiff(oracle, test::to_mat(bgr_of_yuv422(pairs, order)), difference);
    double largest = 0.0;
    cv::minMaxLoc(difference.reshape(1), nullptr, &largest);
    EXPECT_LE(largest, 1.0);
    EXPECT_TRUE(test::same_pixels(grey_of_yuv422(pairs, order), test::byte_image(oracle_grey)));
  }
}

}  // namespace
}  // namespace penumbra
