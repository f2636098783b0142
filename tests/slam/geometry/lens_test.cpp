#include "slam/geometry/lens.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "slam/geometry/rectification.h"

namespace penumbra::slam {
namespace {

// 4 to 14 coefficients as a wide lens has them, with a prism and a tilt that show.
constexpr double kCoefficients[] = {0.31,   -0.05,  0.0012, -0.0008, 0.002,  0.45,  -0.03,
                                    0.0015, 0.0021, -0.001, 0.0014,  0.0007, 0.035, -0.021};

LensCamera lens_of(std::size_t coefficients) {
  return {
      420.0, 417.0, 318.0, 243.0, LensModel::radial_tangential, {kCoefficients, kCoefficients + coefficients},
      640,   480};
}

const cv::Matx33d& matrix_of_lens() {
  static const cv::Matx33d matrix(420.0, 0.0, 318.0, 0.0, 417.0, 243.0, 0.0, 0.0, 1.0);
  return matrix;
}

TEST(Lens, ShowsDirectionsWhereOpenCVDoes) {
  for (const std::size_t count : {0U, 4U, 5U, 8U, 12U, 14U}) {
    const LensCamera lens = lens_of(count);
    std::vector<cv::Point3d> points;
    for (double y = -0.5; y <= 0.5; y += 0.125) {
      for (double x = -0.7; x <= 0.7; x += 0.175) points.emplace_back(2.0 * x, 2.0 * y, 2.0);
    }
    std::vector<cv::Point2d> seen, back;
    const std::vector<double>& distortion = lens.distortion;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix_of_lens(), distortion, seen);
    cv::undistortPoints(seen, back, matrix_of_lens(), distortion);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d direction(points[i].x / 2.0, points[i].y / 2.0);
      const Eigen::Vector2d pixel = pixel_of(lens, direction);
      EXPECT_NEAR(pixel.x(), seen[i].x, 1e-9) << count;
      EXPECT_NEAR(pixel.y(), seen[i].y, 1e-9) << count;
      // Both go the same five rounds.
      const Eigen::Vector2d found = direction_of(lens, pixel);
      EXPECT_NEAR(found.x(), back[i].x, 1e-9) << count;
      EXPECT_NEAR(found.y(), back[i].y, 1e-9) << count;
      EXPECT_NEAR((found - direction).norm(), 0.0, 5e-3) << count;
    }
  }
}

// The second way: the maps that undistort images.
TEST(Lens, UndistortsAsOpenCVDoes) {
  for (const std::size_t count : {8U, 12U, 14U}) {
    const LensCamera lens = lens_of(count);
    cv::Mat map_x, map_y;
    const cv::Matx33d flat(300.0, 0.0, 320.0, 0.0, 300.0, 240.0, 0.0, 0.0, 1.0);
    cv::initUndistortRectifyMap(matrix_of_lens(), lens.distortion, cv::Matx33d::eye(), flat, {640, 480},
                                CV_32F, map_x, map_y);
    for (int y = 0; y < 480; y += 37) {
      for (int x = 0; x < 640; x += 41) {
        const Eigen::Vector2d pixel = pixel_of(lens, {(x - 320.0) / 300.0, (y - 240.0) / 300.0});
        EXPECT_NEAR(pixel.x(), map_x.at<float>(y, x), 2e-4) << count;
        EXPECT_NEAR(pixel.y(), map_y.at<float>(y, x), 2e-4) << count;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra::slam
