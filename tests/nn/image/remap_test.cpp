#include "nn/image/remap.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class RemapTest : public test::EveryIsa {};

// A turn by some degrees and a stretch, with places far outside, halfway between pixels and nowhere at all.
struct Table {
  FloatImage x, y;
  Table(const Size& size, const Size& source) : x(size.width, size.height), y(size.width, size.height) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        x.at(u, v) = 1.07F * static_cast<float>(u) - 0.2F * static_cast<float>(v) - 3.3F;
        y.at(u, v) = 0.2F * static_cast<float>(u) + 0.93F * static_cast<float>(v) - 5.1F;
      }
    }
    const float values[] = {
        -1.0F,     -0.5F,      0.5F, 1.5F,  0.015625F, 0.046875F,    static_cast<float>(source.width) - 1.0F,
        kInfinity, -kInfinity, 1e9F, -1e9F, 40000.0F,  std::nanf("")};
    for (std::size_t i = 0; i < std::size(values) && i < x.elements(); ++i) {
      x.data()[i] = values[i];
      y.data()[x.elements() - 1 - i] = values[i];
    }
  }
};

ByteImage naive_linear(const ByteImage& in, const Table& table) {
  ByteImage out(table.x.width(), table.x.height(), in.channels());
  const auto fixed = [](float a) {
    return std::abs(a * 32.0F) < 2147483648.0F ? static_cast<int>(std::lrint(a * 32.0F))
                                               : std::numeric_limits<int>::min();
  };
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      const int x = fixed(table.x.at(u, v)), y = fixed(table.y.at(u, v));
      for (int c = 0; c < in.channels(); ++c) {
        const auto pixel = [&](int i, int j) {
          return static_cast<int>(in.at(std::clamp((x >> 5) + i, 0, in.width() - 1),
                                        std::clamp((y >> 5) + j, 0, in.height() - 1), c));
        };
        const int a = x & 31, b = y & 31;
        const int sum = (pixel(0, 0) * (32 - a) + pixel(1, 0) * a) * (32 - b) +
                        (pixel(0, 1) * (32 - a) + pixel(1, 1) * a) * b;
        out.at(u, v, c) = static_cast<std::uint8_t>((sum + 512) >> 10);
      }
    }
  }
  return out;
}

// Places that no whole number holds are far left, or far up, here. OpenCV leaves them to the processor: x86
// does the same, ARM takes the nearest number, and 0 for NaN; there it is no oracle of them.
bool oracle_knows(const Table& table, int u, int v) {
#if defined(__x86_64__)
  constexpr bool kAsHere = true;
#else
  constexpr bool kAsHere = false;
#endif
  const auto fits = [](float a) { return std::abs(a * 32.0F) < 2147483648.0F; };
  return kAsHere || (fits(table.x.at(u, v)) && fits(table.y.at(u, v)));
}

TEST_P(RemapTest, LinearIsThatOfTheFormulaAndOfOpenCv) {
  for (const Size source : {Size{2, 2}, {40, 30}, {300, 100}}) {
    const Table table({313, 90}, source);
    const Remap remap(table.x, table.y, source);
    cv::Mat places, weights;
    cv::convertMaps(test::to_mat(table.x), test::to_mat(table.y), places, weights, CV_16SC2, false);
    for (const int channels : {1, 3}) {
      for (const ByteImage& image : {test::noise_image(source.width, source.height, channels),
                                     test::extreme_image(source.width, source.height, channels)}) {
        const ByteImage out = remap.linear(image);
        EXPECT_TRUE(test::same_pixels(out, naive_linear(image, table)));
        cv::Mat oracle;
        cv::remap(test::to_mat(image), oracle, places, weights, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        ByteImage expected = test::byte_image(oracle);
        for (int v = 0; v < out.height(); ++v) {
          for (int u = 0; u < out.width(); ++u) {
            if (oracle_knows(table, u, v)) continue;
            for (int c = 0; c < channels; ++c) expected.at(u, v, c) = out.at(u, v, c);
          }
        }
        EXPECT_TRUE(test::same_pixels(out, expected));
      }
    }
  }
}

TEST(Remap, NearestTakesThePixelsOfOpenCvAndNothingBeyondTheBorder) {
  const Size source{120, 50};
  const Table table({90, 60}, source);
  WordImage image(source.width, source.height);
  for (std::size_t i = 0; i < image.elements(); ++i)
    image.data()[i] = static_cast<std::uint16_t>(counter_random(3, i));
  cv::Mat places, unused, oracle;
  cv::convertMaps(test::to_mat(table.x), test::to_mat(table.y), places, unused, CV_16SC2, true);
  cv::remap(test::to_mat(image), oracle, places, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
            cv::Scalar(0));
  const Remap remap(table.x, table.y, source);
  const WordImage out = remap.nearest(image);
  FloatImage floats(source.width, source.height);
  std::copy_n(image.data(), image.elements(), floats.data());
  const FloatImage float_out = remap.nearest(floats);
  int outside = 0;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      if (oracle_knows(table, x, y)) {
        ASSERT_EQ(out.at(x, y), oracle.at<std::uint16_t>(y, x)) << x << " " << y;
      }
      ASSERT_EQ(float_out.at(x, y), static_cast<float>(out.at(x, y)));
      outside += out.at(x, y) == 0;
    }
  }
  EXPECT_GT(outside, 100);
}

TEST(Remap, WithoutATableLeavesImagesAsTheyAre) {
  const ByteImage image = test::noise_image(8, 8);
  EXPECT_EQ(Remap().linear(image).data(), image.data());
}

INSTANTIATE_TEST_SUITE_P(Isa, RemapTest, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra
