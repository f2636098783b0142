// Polygons to masks: by hand, against a walk along every grid point, and near OpenCV's fill.
#include "nn/evaluation/polygon_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace penumbra::nn {
namespace {

cv::Mat1b to_image(const RunMask& mask) {
  cv::Mat1b image(mask.height, mask.width, std::uint8_t{0});
  for (const PixelRun& run : mask.runs) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      image(static_cast<int>(i) % mask.height, static_cast<int>(i) / mask.height) = 1;
    }
  }
  return image;
}

bool equal(const cv::Mat1b& a, const cv::Mat1b& b) { return cv::countNonZero(a != b) == 0; }

// The definition, one grid point after the other: the outline as a list of points on the grid, then for every
// column the rows where the outline crosses it, and pixels that have an odd number of crossings at or above.
cv::Mat1b walk(const std::vector<double>& xy, int width, int height) {
  struct Point {
    int u, v;
  };
  std::vector<Point> outline;
  const std::size_t count = xy.size() / 2;
  const auto grid = [&](std::size_t i) { return static_cast<int>(5 * xy[i] + 0.5); };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + 1) % count;
    Point a{grid(2 * i), grid(2 * i + 1)}, b{grid(2 * j), grid(2 * j + 1)};
    const int dx = std::abs(b.u - a.u), dy = std::abs(b.v - a.v), steps = std::max(dx, dy);
    const bool wide = dx >= dy, turned = wide ? a.u > b.u : a.v > b.v;
    if (turned) std::swap(a, b);
    std::vector<Point> edge;
    const double slope = steps == 0 ? 0.0 : double(wide ? b.v - a.v : b.u - a.u) / steps;
    for (int s = 0; s <= steps; ++s) {
      const int beside = static_cast<int>((wide ? a.v : a.u) + slope * s + 0.5);
      edge.push_back(wide ? Point{a.u + s, beside} : Point{beside, a.v + s});
    }
    if (turned) std::reverse(edge.begin(), edge.end());
    outline.insert(outline.end(), edge.begin(), edge.end());
  }
  std::vector<std::vector<int>> crossings(static_cast<std::size_t>(width));
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Point &a = outline[i - 1], &b = outline[i];
    const int u = std::min(a.u, b.u);
    if (a.u == b.u || u < 0 || u % 5 != 2 || u / 5 >= width) continue;
    const double row = std::clamp((std::min(a.v, b.v) + 0.5) / 5 - 0.5, 0.0, double(height));
    crossings[static_cast<std::size_t>(u / 5)].push_back(static_cast<int>(std::ceil(row)));
  }
  cv::Mat1b image(height, width, std::uint8_t{0});
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) {
      const auto& rows = crossings[static_cast<std::size_t>(x)];
      image(y, x) = std::count_if(rows.begin(), rows.end(), [&](int row) { return row <= y; }) % 2;
    }
  }
  return image;
}

TEST(PolygonRaster, SmallPolygonsAreTheseVeryPixels) {
  const cv::Mat1b rectangle = (cv::Mat1b(4, 5) << 0, 0, 0, 0, 0,  //
                               0, 1, 1, 1, 0,                     //
                               0, 1, 1, 1, 0,                     //
                               0, 0, 0, 0, 0);
  EXPECT_TRUE(
      equal(to_image(rasterise_polygon(std::vector<double>{1, 1, 4, 1, 4, 3, 1, 3}, 5, 4)), rectangle));
  const cv::Mat1b triangle = (cv::Mat1b(4, 5) << 1, 1, 1, 0, 0,  //
                              1, 1, 0, 0, 0,                     //
                              1, 0, 0, 0, 0,                     //
                              0, 0, 0, 0, 0);
  EXPECT_TRUE(equal(to_image(rasterise_polygon(std::vector<double>{0, 0, 4, 0, 0, 4}, 5, 4)), triangle));
}

TEST(PolygonRaster, FollowsTheDefinitionOnRandomPolygons) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    const int width = 1 + static_cast<int>(random() % 40), height = 1 + static_cast<int>(random() % 40);
    std::uniform_real_distribution<double> x(-10.0, width + 10.0), y(-10.0, height + 10.0);
    std::vector<double> xy;
    const bool whole = trial % 3 == 0;  // vertices on pixel corners, straight and double edges
    for (unsigned i = 0, count = 3 + random() % 12; i < count; ++i) {
      for (const double value : {x(random), y(random)})
        xy.push_back(whole ? std::round(value / 4) * 4 : value);
    }
    ASSERT_TRUE(equal(to_image(rasterise_polygon(xy, width, height)), walk(xy, width, height))) << trial;
  }
}

TEST(PolygonRaster, IsCloseToOpenCvsFill) {
  std::vector<double> xy;
  std::vector<cv::Point> points;
  for (int i = 0; i < 40; ++i) {
    const double angle = i * 2.0 * CV_PI / 40, radius = i % 2 == 0 ? 90.0 : 60.0;
    xy.push_back(100.0 + radius * std::cos(angle));
    xy.push_back(100.0 + radius * std::sin(angle));
    constexpr double kFixed = 16.0;  // fillPoly's pixel centres are whole numbers, COCO's lie at + 0.5
    points.emplace_back(cvRound((xy[xy.size() - 2] - 0.5) * kFixed), cvRound((xy.back() - 0.5) * kFixed));
  }
  cv::Mat1b filled(200, 200, std::uint8_t{0});
  cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{points}, 1, cv::LINE_8, 4);
  const cv::Mat1b image = to_image(rasterise_polygon(xy, 200, 200));
  // fillPoly draws the outline too, so it covers more; both agree but for pixels beside the outline.
  EXPECT_EQ(cv::countNonZero(image & (filled == 0)), 0);
  cv::Mat1b inner;
  cv::erode(filled, inner, {}, {-1, -1}, 2);
  EXPECT_EQ(cv::countNonZero(inner & (image == 0)), 0);
  double twice_area = 0.0;
  for (std::size_t i = 0; i < xy.size(); i += 2) {
    const std::size_t j = (i + 2) % xy.size();
    twice_area += xy[i] * xy[j + 1] - xy[j] * xy[i + 1];
  }
  EXPECT_NEAR(cv::countNonZero(image), twice_area / 2, 0.01 * twice_area);
}

TEST(PolygonRaster, PolygonsWithoutAreaAndFarOutsideAreEmptyOrClipped) {
  EXPECT_EQ(area(rasterise_polygon(std::vector<double>{3, 3, 3, 3, 3, 3}, 8, 8)), 0U);
  EXPECT_EQ(area(rasterise_polygon(std::vector<double>{1, 2, 7, 2, 4, 2}, 8, 8)), 0U);
  EXPECT_EQ(area(rasterise_polygon(std::vector<double>{20, 2, 30, 2, 30, 8}, 8, 8)), 0U);
  EXPECT_EQ(area(rasterise_polygon(std::vector<double>{-9, -9, -2, -9, -2, -3}, 8, 8)), 0U);
  const double far = kLargestCoordinate;
  const std::vector<double> all{-far, -far, far, -far, far, far, -far, far};
  EXPECT_EQ(area(rasterise_polygon(all, 8, 9)), 72U);
  // Steep edges far above: every column is found without walking to it.
  std::vector<double> comb;
  for (int i = 0; i < 1000; ++i) comb.insert(comb.end(), {i % 8 + 0.3, i % 2 == 0 ? -far : far});
  EXPECT_LE(area(rasterise_polygon(comb, 8, 8)), 64U);
}

TEST(PolygonRaster, PartsOfAnObjectAreUnited) {
  const RunMask mask = rasterise_polygons({{1, 1, 4, 1, 4, 3, 1, 3}, {3, 2, 5, 2, 5, 4, 3, 4}}, 5, 4);
  EXPECT_EQ(area(mask), 6U + 4U - 1U);
}

}  // namespace
}  // namespace penumbra::nn
