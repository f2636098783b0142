#include "nn/image/grey.h"

#include <opencv2/imgproc.hpp>

#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class GreyTest : public test::EveryIsa {};

TEST_P(GreyTest, IsThatOfTheFormulaAndOfOpenCv) {
  for (const int width : {1, 15, 16, 17, 64, 257}) {
    for (const ByteImage& colour : {test::noise_image(width, 40, 3), test::extreme_image(width, 40, 3)}) {
      const ByteImage grey = to_grey(colour);
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < width; ++x) {
          const int sum = 3735 * colour.at(x, y, 0) + 19235 * colour.at(x, y, 1) + 9798 * colour.at(x, y, 2);
          ASSERT_EQ(grey.at(x, y), (sum + 16384) / 32768);
        }
      }
      cv::Mat oracle;
      cv::cvtColor(test::to_mat(colour), oracle, cv::COLOR_BGR2GRAY);
      EXPECT_TRUE(test::same_pixels(grey, test::byte_image(oracle)));
    }
  }
  const ByteImage grey = test::noise_image(5, 5);
  EXPECT_EQ(to_grey(grey).data(), grey.data());
}

TEST_P(GreyTest, SlopesAreThoseOfOpenCvsSobel) {
  for (const Size size : {Size{1, 1}, {1, 9}, {2, 2}, {9, 1}, {70, 30}, {1300, 5}}) {
    for (const ByteImage& image :
         {test::noise_image(size.width, size.height), test::extreme_image(size.width, size.height),
          test::square_image(size.width, size.height)}) {
      cv::Mat1f gx, gy;
      cv::Sobel(test::to_mat(image), gx, CV_32F, 1, 0, 3, 1.0 / 8.0);
      cv::Sobel(test::to_mat(image), gy, CV_32F, 0, 1, 3, 1.0 / 8.0);
      for (const double threshold : {0.0, 400.0, 3000.1}) {
        double sum = 0.0;
        for (int y = 0; y < size.height; ++y) {
          for (int x = 0; x < size.width; ++x) {
            const double S = double{gx(y, x)} * gx(y, x) + double{gy(y, x)} * gy(y, x);
            if (S > threshold) sum += S;
          }
        }
        EXPECT_EQ(slope_energy(image, threshold), sum) << size.width << " " << threshold;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, GreyTest, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra
