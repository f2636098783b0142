#include "nn/image/point_flow.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "nn/image/fast_corners.h"
#include "tests/support/cv_images.h"
#include "tests/support/image_cases.h"

namespace penumbra {
namespace {

class PointFlowTest : public test::EveryIsa {};

// An image as a camera's: structure at several scales, no edge sharper than its pixels.
cv::Mat camera_image(std::uint64_t seed) {
  cv::Mat image = test::to_mat(test::square_image(400, 300, seed));
  cv::GaussianBlur(image, image, {0, 0}, 1.2);
  return image;
}

// The image moved by (dx, dy) and turned a little about its middle.
cv::Mat moved(const cv::Mat& image, double dx, double dy, double turn) {
  const double c = std::cos(turn), s = std::sin(turn), x = 200.0, y = 150.0;
  const cv::Mat move =
      (cv::Mat_<double>(2, 3) << c, -s, x - c * x + s * y + dx, s, c, y - s * x - c * y + dy);
  cv::Mat out;
  cv::warpAffine(image, out, move, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return out;
}

// Corners, as the front end tracks them, and places a little beside them.
std::vector<FlowPoint> corners_of(const cv::Mat& image) {
  FastCorners fast;
  const Rect inside{60, 60, 280, 180};
  std::vector<Corner> corners;
  fast.measure(test::byte_image(image), inside, 7);
  fast.find(inside, 7, corners);
  std::vector<FlowPoint> points;
  for (const Corner& c : corners)
    points.push_back({static_cast<float>(c.x) + 0.3F, static_cast<float>(c.y) - 0.2F, false});
  return points;
}

TEST_P(PointFlowTest, FindsPointsWhereTheyWentAndWhereOpenCvDoes) {
  for (const auto& [dx, dy, turn] : {std::tuple{0.4, -0.3, 0.0}, {7.3, 4.6, 0.01}, {-18.0, 11.5, 0.0}}) {
    const cv::Mat from = camera_image(3), to = moved(from, dx, dy, turn);
    HalvingPyramid a, b;
    a.build(test::byte_image(from), 4);
    b.build(test::byte_image(to), 4);
    const std::vector<FlowPoint> points = corners_of(from);
    std::vector<FlowPoint> found = points;
    track_points(a, b, points, found);

    std::vector<cv::Point2f> start, theirs;
    for (const FlowPoint& p : points) start.emplace_back(p.x, p.y);
    std::vector<unsigned char> status;
    cv::calcOpticalFlowPyrLK(from, to, start, theirs, status, cv::noArray());
    int both = 0, near = 0, right = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!found[i].found || status[i] == 0) continue;
      ++both;
      near += std::hypot(found[i].x - theirs[i].x, found[i].y - theirs[i].y) < 0.05;
      const double x = points[i].x - 200.0, y = points[i].y - 150.0;
      const double u = 200.0 + std::cos(turn) * x - std::sin(turn) * y + dx,
                   v = 150.0 + std::sin(turn) * x + std::cos(turn) * y + dy;
      right += std::hypot(found[i].x - u, found[i].y - v) < 0.2;
    }
    ASSERT_GT(points.size(), 50U);
    EXPECT_GT(both, 0.8 * static_cast<double>(points.size()));
    EXPECT_GE(near, 0.95 * both) << dx;
    EXPECT_GE(right, 0.95 * both) << dx;
  }
}

TEST_P(PointFlowTest, LosesPointsThatLeaveOrShowNothing) {
  ByteImage image = test::square_image(200, 100);
  for (int y = 0; y < 100; ++y) std::fill_n(image.row(y), 80, std::uint8_t{70});
  HalvingPyramid pyramid;
  pyramid.build(image, 3);
  std::vector<FlowPoint> points = {{40.0F, 50.0F}, {199.0F, 50.0F},        {140.0F, 3.0F},
                                   {-1e9F, 5.0F},  {std::nanf(""), 50.0F}, {140.0F, 50.0F}};
  std::vector<FlowPoint> found = points;
  track_points(pyramid, pyramid, points, found);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) EXPECT_FALSE(found[i].found) << i;
  ASSERT_TRUE(found.back().found);
  EXPECT_NEAR(found.back().x, 140.0F, 1e-3F);
  EXPECT_NEAR(found.back().y, 50.0F, 1e-3F);
}

// Whole numbers throughout: every instruction set finds the same bits.
TEST_P(PointFlowTest, IsTheSameOnEveryInstructionSet) {
  const cv::Mat from = camera_image(5), to = moved(from, 3.0, -2.0, 0.02);
  const auto track = [&](nn::Isa isa) {
    nn::use_isa(isa);
    HalvingPyramid a, b;
    a.build(test::byte_image(from), 4);
    b.build(test::byte_image(to), 4);
    const std::vector<FlowPoint> points = corners_of(from);
    std::vector<FlowPoint> found = points;
    track_points(a, b, points, found);
    return found;
  };
  const std::vector<FlowPoint> here = track(GetParam()), there = track(nn::Isa::baseline);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_EQ(here[i].x, there[i].x);
    EXPECT_EQ(here[i].y, there[i].y);
    EXPECT_EQ(here[i].found, there[i].found);
  }
}

TEST_P(PointFlowTest, HalvesImagesAsOpenCvDoes) {
  for (const Size size : {Size{64, 48}, {65, 33}, {7, 5}, {3, 3}}) {
    const ByteImage image = test::noise_image(size.width, size.height);
    HalvingPyramid pyramid;
    pyramid.build(image, 2);
    ASSERT_EQ(pyramid.levels(), 2);
    cv::Mat oracle;
    cv::pyrDown(test::to_mat(image), oracle);
    EXPECT_TRUE(test::same_pixels(pyramid.level(1), test::byte_image(oracle))) << size.width;
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, PointFlowTest, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra
