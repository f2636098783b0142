#include "slam/evaluation/trajectory_plot.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "nn/base/error.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"
#include "tests/support/trajectories.h"

namespace penumbra::slam {
namespace {

using test::path_through;

// Colours of the drawing, BGR.
const cv::Vec3b kTruth(150, 150, 150), kEstimate(178, 114, 0), kStart(115, 158, 0), kEnd(0, 94, 213);

// Where pixels of a colour lie inside the plot's frame; empty where there are none.
cv::Rect extent_of(const cv::Mat& picture, const cv::Vec3b& colour) {
  cv::Mat1b mask;
  cv::inRange(picture, colour, colour, mask);
  mask = mask(cv::Rect(104, 134, picture.cols - 158, picture.rows - 228));
  std::vector<cv::Point> pixels;
  cv::findNonZero(mask, pixels);
  if (pixels.empty()) return {};
  cv::Point low = pixels.front(), high = low;
  for (const cv::Point& pixel : pixels) {
    low = {std::min(low.x, pixel.x), std::min(low.y, pixel.y)};
    high = {std::max(high.x, pixel.x), std::max(high.y, pixel.y)};
  }
  return {low, high + cv::Point(1, 1)};
}

cv::Mat drawn(const PlotCanvas& plot) { return test::to_mat(plot.picture()); }

void expect_picture(const cv::Mat& picture) {
  EXPECT_EQ(picture.type(), CV_8UC3);
  for (const int side : {picture.cols, picture.rows}) {
    EXPECT_GE(side, 1000);
    EXPECT_LE(side, 1500);
  }
}

TEST(TrajectoryPlot, XIsToTheRightZUpAndTheScaleEqual) {
  // A square of 30 m, from the lower left corner counter-clockwise; y must not matter.
  const Trajectory square = path_through({{0, 5, 0}, {30, -7, 0}, {30, 2, 30}, {0, 90, 30}});
  const cv::Mat picture = drawn(draw_trajectories(square, {}));
  expect_picture(picture);
  const cv::Rect start = extent_of(picture, kStart), end = extent_of(picture, kEnd);
  const cv::Rect path = extent_of(picture, kEstimate);
  ASSERT_FALSE(start.empty() || end.empty() || path.empty());
  EXPECT_GT(start.y, end.y);       // the end lies up
  EXPECT_NEAR(start.x, end.x, 4);  // and at the same x
  EXPECT_NEAR(path.width, path.height, 20);
  EXPECT_GT(path.width, 700);
  EXPECT_TRUE(extent_of(picture, kTruth).empty());
}

TEST(TrajectoryPlot, PlaneXyLooksAlongZ) {
  const Trajectory path = path_through({{0, 0, 0}, {0, 10, 90}});
  TrajectoryPlotOptions options;
  options.plane = PlotPlane::xy;
  const cv::Mat picture = drawn(draw_trajectories(path, {}, options));
  EXPECT_GT(extent_of(picture, kStart).y, extent_of(picture, kEnd).y);
}

TEST(TrajectoryPlot, GroundTruthShowsBesideTheEstimate) {
  const cv::Mat picture =
      drawn(draw_trajectories(path_through({{0, 0, 0}, {0, 0, 50}}), path_through({{5, 0, 0}, {5, 0, 50}})));
  expect_picture(picture);
  EXPECT_FALSE(extent_of(picture, kTruth).empty());
  EXPECT_FALSE(extent_of(picture, kEstimate).empty());
}

TEST(TrajectoryPlot, OnePoseAndExtremeShapesAreDrawn) {
  expect_picture(drawn(draw_trajectories(path_through({{1, 2, 3}}), {})));
  expect_picture(drawn(draw_trajectories(path_through({{0, 0, 0}, {1e6, 0, 0}}), {})));
  expect_picture(drawn(draw_trajectories(path_through({{0, 0, 0}, {0, 0, 1e-6}}), {})));
  expect_picture(drawn(draw_trajectories(path_through({{1e12, 0, 1e12}, {1e12 + 1, 0, 1e12}}), {})));
  expect_picture(drawn(draw_trajectories(path_through({{1e18, 0, 1e18}, {1e18, 0, 1e18}}), {})));
  expect_picture(drawn(draw_trajectories(path_through({{-1e150, 0, 0}, {1e150, 0, 3}}), {})));
}

TEST(TrajectoryPlot, TheSvgHoldsThePathAndItsWordsEscaped) {
  TrajectoryPlotOptions options;
  options.title = "a < b & \"c\"";
  const std::string svg = draw_trajectories(path_through({{0, 0, 0}, {0, 0, 50}}), {}, options).svg();
  EXPECT_TRUE(svg.starts_with("<svg xmlns=")) << svg.substr(0, 80);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  for (const char* part :
       {"a &lt; b &amp; &quot;c&quot;", "<polyline", "stroke=\"#0072b2\"", ">start<", ">x (m)<"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

TEST(TrajectoryPlot, WhatCannotBeDrawnIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double huge = std::numeric_limits<double>::max();
  test::expect_error<Error>([] { draw_trajectories({}, {}); }, {"without a pose"});
  test::expect_error<Error>([&] { draw_trajectories(path_through({{nan, 0, 0}}), {}); }, {"not finite"});
  test::expect_error<Error>(
      [&] {
        draw_trajectories(path_through({{-huge, 0, 0}, {huge, 0, 0}}), {});
      },
      {"without bounds"});
}

}  // namespace
}  // namespace penumbra::slam
