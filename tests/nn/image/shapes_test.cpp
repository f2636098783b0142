#include "nn/image/shapes.h"

#include <opencv2/imgproc.hpp>

#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

std::vector<Pixel> random_pixels(int count, int width, int height, std::uint64_t seed) {
  std::vector<Pixel> pixels;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
    pixels.push_back(
        {static_cast<int>(counter_random(seed, 2 * i) % static_cast<std::uint64_t>(width)),
         static_cast<int>(counter_random(seed, 2 * i + 1) % static_cast<std::uint64_t>(height))});
  }
  return pixels;
}

std::vector<cv::Point> to_cv(const std::vector<Pixel>& pixels) {
  std::vector<cv::Point> points;
  for (const Pixel& p : pixels) points.emplace_back(p.x, p.y);
  return points;
}

TEST(Shapes, DiscsAreOpenCvs) {
  for (int radius = 0; radius <= 40; ++radius) {
    for (const Pixel& centre : {Pixel{50, 45}, {3, 2}, {-10, 60}, {99, 89}, {200, 200}}) {
      ByteImage ours = ByteImage::filled(100, 90, 0);
      fill_disc(ours, centre, radius, 255);
      cv::Mat1b theirs(90, 100, std::uint8_t{0});
      cv::circle(theirs, {centre.x, centre.y}, radius, 255, cv::FILLED);
      EXPECT_TRUE(test::same_pixels(ours, test::byte_image(theirs))) << radius;
    }
  }
}

TEST(Shapes, HullsAndTheirPixelsAreOpenCvs) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::vector<Pixel> pixels = random_pixels(1 + static_cast<int>(seed % 30), 80, 60, seed);
    const std::vector<Pixel> hull = convex_hull(pixels);
    std::vector<cv::Point> oracle;
    cv::convexHull(to_cv(pixels), oracle);
    EXPECT_EQ(hull.size(), oracle.size()) << seed;
    for (const Pixel& p : hull)
      EXPECT_NE(std::find(oracle.begin(), oracle.end(), cv::Point(p.x, p.y)), oracle.end());
    ByteImage ours = ByteImage::filled(80, 60, 0);
    fill_convex(ours, hull, 255);
    cv::Mat1b theirs(60, 80, std::uint8_t{0});
    cv::fillConvexPoly(theirs, oracle, 255);
    EXPECT_TRUE(test::same_pixels(ours, test::byte_image(theirs))) << seed;
    for (const Pixel& p : pixels) EXPECT_EQ(ours.at(p.x, p.y), 255);
  }
}

TEST(Shapes, PolygonsAreCutToTheMask) {
  ByteImage mask = ByteImage::filled(10, 10, 0);
  fill_convex(mask, std::vector<Pixel>{{-5, -5}, {20, -5}, {20, 4}, {-5, 4}}, 255);
  EXPECT_EQ(count_pixels(mask), 50);
  fill_convex(mask, std::vector<Pixel>{}, 255);
  EXPECT_EQ(count_pixels(mask), 50);
}

TEST(Shapes, ComponentsAreOpenCvsInTheirOrder) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const int width = 1 + static_cast<int>(counter_random(seed, 0) % 90);
    const int height = 1 + static_cast<int>(counter_random(seed, 1) % 50);
    ByteImage mask = test::noise_image(width, height, 1, seed);
    const std::uint8_t share = static_cast<std::uint8_t>(40 + 3 * seed);
    for (std::size_t i = 0; i < mask.elements(); ++i) mask.data()[i] = mask.data()[i] < share ? 255 : 0;
    Image<std::int32_t> labels;
    const int count = connected_components(mask, labels);
    cv::Mat1i oracle;
    EXPECT_EQ(count, cv::connectedComponents(test::to_mat(mask), oracle) - 1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(labels.at(x, y), oracle(y, x)) << seed << " " << x << " " << y;
    EXPECT_EQ(count_pixels(mask), cv::countNonZero(test::to_mat(mask)));
  }
}

TEST(Shapes, BoundsHoldAllPixels) {
  ByteImage mask = ByteImage::filled(30, 20, 0);
  EXPECT_TRUE(bounds_of(mask).empty());
  mask.at(4, 7) = 1;
  EXPECT_EQ(bounds_of(mask), (Rect{4, 7, 1, 1}));
  mask.at(29, 2) = 1;
  EXPECT_EQ(bounds_of(mask), (Rect{4, 2, 26, 6}));
}

}  // namespace
}  // namespace penumbra
