#include "nn/image/blur.h"

#include <opencv2/imgproc.hpp>

#include "nn/image/border.h"
#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class BlurTest : public test::EveryIsa {};

ByteImage naive_blur(const ByteImage& in) {
  constexpr int kWeights[7] = {18, 34, 48, 56, 48, 34, 18};
  ByteImage out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      int sum = 32768;
      for (int j = -3; j <= 3; ++j)
        for (int i = -3; i <= 3; ++i)
          sum += kWeights[i + 3] * kWeights[j + 3] *
                 in.at(mirrored(x + i, in.width()), mirrored(y + j, in.height()));
      out.at(x, y) = static_cast<std::uint8_t>(sum >> 16);
    }
  }
  return out;
}

TEST_P(BlurTest, IsThatOfTheFormulaAndOfOpenCv) {
  GaussianBlur blur;
  ByteImage out;
  for (const Size size : {Size{1, 1}, {2, 5}, {3, 3}, {8, 4}, {37, 21}, {130, 40}}) {
    for (const ByteImage& image :
         {test::noise_image(size.width, size.height), test::extreme_image(size.width, size.height),
          ByteImage::filled(size.width, size.height, 255)}) {
      blur.apply(image, out);
      EXPECT_TRUE(test::same_pixels(out, naive_blur(image)));
      cv::Mat oracle;
      cv::GaussianBlur(test::to_mat(image), oracle, {7, 7}, 2.0, 2.0, cv::BORDER_REFLECT_101);
      EXPECT_TRUE(test::same_pixels(out, test::byte_image(oracle)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, BlurTest, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra
