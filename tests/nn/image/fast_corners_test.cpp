#include "nn/image/fast_corners.h"

#include <algorithm>
#include <opencv2/features2d.hpp>

#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class FastCornersTest : public test::EveryIsa {};

constexpr int kX[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
constexpr int kY[16] = {3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};

// The definition: the highest threshold at which nine in a row are all brighter, or all darker.
int naive_score(const ByteImage& image, int x, int y) {
  int best = 0;
  for (const int sign : {1, -1}) {
    for (int begin = 0; begin < 16; ++begin) {
      int least = 255;
      for (int k = begin; k < begin + 9; ++k)
        least = std::min(least, sign * (image.at(x + kX[k % 16], y + kY[k % 16]) - image.at(x, y)));
      best = std::max(best, least - 1);
    }
  }
  return best;
}

std::vector<Corner> naive_corners(const ByteImage& image, const Rect& where, int threshold) {
  const auto score = [&](int x, int y) { return where.contains(x, y) ? naive_score(image, x, y) : 0; };
  std::vector<Corner> corners;
  for (int y = where.y; y < where.y + where.height; ++y) {
    for (int x = where.x; x < where.x + where.width; ++x) {
      const int here = score(x, y);
      if (here < threshold) continue;
      bool highest = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) highest &= (dx == 0 && dy == 0) || score(x + dx, y + dy) < here;
      if (highest) corners.push_back({x, y, here});
    }
  }
  return corners;
}

std::vector<Corner> opencv_corners(const ByteImage& image, const Rect& where, int threshold) {
  constexpr int kRadius = FastCorners::kRadius;
  std::vector<cv::KeyPoint> found;
  const Rect seen{where.x - kRadius, where.y - kRadius, where.width + 2 * kRadius,
                  where.height + 2 * kRadius};
  cv::FAST(test::to_mat<std::uint8_t>(image.region(seen)), found, threshold, true);
  std::vector<Corner> corners;
  for (const cv::KeyPoint& k : found) {
    corners.push_back(
        {static_cast<int>(k.pt.x) + seen.x, static_cast<int>(k.pt.y) + seen.y, static_cast<int>(k.response)});
  }
  return corners;
}

Rect inside(const ByteImage& image) {
  constexpr int kRadius = FastCorners::kRadius;
  return {kRadius, kRadius, image.width() - 2 * kRadius, image.height() - 2 * kRadius};
}

TEST_P(FastCornersTest, AreThoseOfTheDefinitionAndOfOpenCv) {
  for (const Size size : {Size{7, 7}, {40, 9}, {71, 30}, {133, 40}, {200, 64}}) {
    for (const ByteImage& image :
         {test::noise_image(size.width, size.height), test::square_image(size.width, size.height),
          test::extreme_image(size.width, size.height)}) {
      for (const int threshold : {1, 7, 20, 100, 254}) {
        FastCorners fast;
        fast.measure(image, inside(image), threshold);
        std::vector<Corner> corners;
        fast.find(inside(image), threshold, corners);
        EXPECT_EQ(corners, naive_corners(image, inside(image), threshold)) << size.width << " " << threshold;
        EXPECT_EQ(corners, opencv_corners(image, inside(image), threshold)) << size.width << " " << threshold;
      }
    }
  }
}

// The ORB extractor measures once and asks for cells.
TEST_P(FastCornersTest, OfACellAreThoseOfTheCellAlone) {
  const ByteImage image = test::square_image(160, 120);
  FastCorners fast;
  fast.measure(image, {16, 16, 128, 88}, 7);
  std::size_t found = 0;
  for (const Rect& cell : {Rect{16, 16, 35, 35}, {51, 16, 35, 35}, {121, 86, 23, 18}, {16, 16, 1, 1}}) {
    std::vector<Corner> corners;
    fast.find(cell, 7, corners);
    EXPECT_EQ(corners, opencv_corners(image, cell, 7));
    found += corners.size();
  }
  EXPECT_GT(found, 10U);
  std::vector<Corner> strong;
  fast.find({16, 16, 128, 88}, 40, strong);
  EXPECT_EQ(strong, opencv_corners(image, {16, 16, 128, 88}, 40));
}

INSTANTIATE_TEST_SUITE_P(Isa, FastCornersTest, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra
