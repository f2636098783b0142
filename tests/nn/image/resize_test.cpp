#include "nn/image/resize.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class ResizeTest : public test::EveryIsa {};

struct SizePair {
  Size from, to;
};
constexpr SizePair kPairs[] = {{{1241, 376}, {1034, 313}}, {{200, 120}, {100, 60}}, {{64, 48}, {50, 37}},
                               {{37, 21}, {90, 55}},       {{100, 9}, {11, 3}},     {{5, 3}, {4, 2}},
                               {{1, 4}, {3, 8}},           {{30, 1}, {20, 5}},      {{17, 17}, {17, 17}}};

ByteImage opencv_resize(const ByteImage& in, const Size& size, int method) {
  cv::Mat out;
  cv::resize(test::to_mat(in), out, {size.width, size.height}, 0.0, 0.0, method);
  return test::byte_image(out);
}

// The formula in floating point, without the weights' 11 bits.
double exact(const ByteImage& in, const Size& size, int u, int v) {
  const double x = std::clamp((u + 0.5) * in.width() / size.width - 0.5, 0.0, in.width() - 1.0);
  const double y = std::clamp((v + 0.5) * in.height() / size.height - 0.5, 0.0, in.height() - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, in.width() - 1), y1 = std::min(y0 + 1, in.height() - 1);
  const double a = x - x0, b = y - y0;
  return (1 - b) * ((1 - a) * in.at(x0, y0) + a * in.at(x1, y0)) +
         b * ((1 - a) * in.at(x0, y1) + a * in.at(x1, y1));
}

TEST_P(ResizeTest, LinearIsThatOfTheFormulaAndOfOpenCv) {
  LinearResize resize;
  ByteImage out;
  for (const auto& [from, to] : kPairs) {
    for (const int channels : {1, 3}) {
      for (const ByteImage& image : {test::noise_image(from.width, from.height, channels),
                                     test::extreme_image(from.width, from.height, channels)}) {
        resize.apply(image, to, out);
        EXPECT_TRUE(test::same_pixels(out, opencv_resize(image, to, cv::INTER_LINEAR)))
            << from.width << " to " << to.width;
        if (channels > 1) continue;
        // Rounding twice, and weights of 11 bits.
        for (int v = 0; v < to.height; ++v)
          for (int u = 0; u < to.width; ++u) ASSERT_NEAR(out.at(u, v), exact(image, to, u, v), 1.0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, ResizeTest, test::every_isa(), test::isa_name);

TEST(Resize, NearestTakesThePixelsOfOpenCv) {
  for (const auto& [from, to] : kPairs) {
    const ByteImage image = test::noise_image(from.width, from.height);
    EXPECT_TRUE(test::same_pixels(resize_nearest<std::uint8_t>(image, to),
                                  opencv_resize(image, to, cv::INTER_NEAREST)));
  }
}

TEST(Resize, AreaIsTheMeanOfWhatAPixelCovers) {
  for (const auto& [from, to] : kPairs) {
    if (to.width > from.width || to.height > from.height) continue;  // OpenCV mixes there instead
    for (const int channels : {1, 3}) {
      const ByteImage image = test::noise_image(from.width, from.height, channels);
      const ByteImage ours = resize_area(image, to), theirs = opencv_resize(image, to, cv::INTER_AREA);
      for (std::size_t i = 0; i < ours.elements(); ++i) ASSERT_NEAR(ours.data()[i], theirs.data()[i], 1);
    }
  }
  ByteImage four(2, 2);
  for (std::uint8_t i = 0; i < 4; ++i) four.data()[i] = static_cast<std::uint8_t>(10 * i + 7);
  EXPECT_EQ(resize_area(four, {1, 1}).at(0, 0), 22);
}

}  // namespace
}  // namespace penumbra
