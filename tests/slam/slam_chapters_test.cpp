// The worked examples of docs/slam: the numbers there are checked here.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "slam/frontend/features/image_pyramid.h"
#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/geometry/reprojection.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {
namespace {

TEST(SlamChapters, Orb) {
  ImagePyramid pyramid;
  pyramid.build(ByteImage::filled(1241, 376, 0), {8, 1.2});
  ASSERT_EQ(pyramid.level(1).width(), 1034);
  EXPECT_NEAR(pyramid.to_full({10.0F, 10.0F}, 1).x(), 12.10, 0.005);
  EXPECT_NEAR(pyramid.to_full({0.0F, 0.0F}, 7).x(), 1.3, 0.05);
  double sum = 0.0;
  const std::vector<double> scales = level_scales({8, 1.2});
  for (const double s : scales) sum += 1.0 / s;
  EXPECT_EQ(std::lround(2000.0 / scales[0] / sum), 434);
  EXPECT_EQ(std::lround(2000.0 / scales[1] / sum), 362);
  EXPECT_EQ(std::lround(2000.0 / scales[7] / sum), 121);
  EXPECT_EQ(hamming_distance({0b1100}, {0b1010}), 2);
}

TEST(SlamChapters, Stereo) {
  StereoCamera camera;
  camera.fx = 718.856;
  camera.baseline = 0.5372;
  const double fb = camera.fx * camera.baseline;
  EXPECT_NEAR(fb, 386.14, 0.05);
  EXPECT_NEAR(camera.depth_from_disparity(38.61), 10.0, 0.005);
  EXPECT_NEAR(camera.depth_from_disparity(9.65), 40.0, 0.05);
  EXPECT_NEAR(10.0 * 10.0 / fb * 0.2, 0.05, 0.005);
  EXPECT_NEAR(40.0 * 40.0 / fb * 0.2, 0.83, 0.005);
}

TEST(SlamChapters, PatchAlignment) {
  const Eigen::Vector3d T(1.0, 0.0, 1.0), g(-2.0, 0.0, 2.0), R(1.5625, 0.0625, 0.5625);
  EXPECT_DOUBLE_EQ(g.squaredNorm(), 8.0);
  EXPECT_DOUBLE_EQ(g.dot(R - T), -2.0);
  EXPECT_DOUBLE_EQ(-g.dot(R - T) / g.squaredNorm(), 0.25);
}

std::vector<char> keep(std::span<const float> distances, MismatchFilterMode mode) {
  std::vector<MatchedPixels> pairs;
  for (const float d : distances) pairs.push_back({{0.0F, 0.0F}, {d, 0.0F}});
  MismatchFilterSettings settings;
  settings.mode = mode;
  std::vector<char> kept;
  filter_mismatches(pairs, settings, kept);
  return kept;
}

TEST(SlamChapters, DisparityAtInfinity) {
  StereoCamera exact;
  exact.fx = 718.856;
  exact.baseline = 386.14 / exact.fx;
  StereoCamera turned = exact;
  turned.disparity_offset = 0.1;
  const auto disparity = [&](double depth) {
    const Eigen::Vector3d pixel = turned.project_stereo({0.0, 0.0, depth});
    return pixel.x() - pixel.z();
  };
  const auto step = [&](const StereoCamera& camera, double depth) {
    return camera.depth_from_disparity(disparity(depth)) -
           camera.depth_from_disparity(disparity(depth - 2.0));
  };
  EXPECT_NEAR(disparity(10.0), 38.71, 0.005);
  EXPECT_NEAR(disparity(38.0), 10.26, 0.005);
  EXPECT_NEAR(step(exact, 10.0), 1.991, 0.0005);
  EXPECT_NEAR(step(exact, 40.0), 1.96, 0.005);
  for (const double depth : {10.0, 40.0}) EXPECT_NEAR(step(turned, depth), 2.0, 1e-12);
}

TEST(SlamChapters, MismatchFilter) {
  constexpr std::array<float, 9> kGross = {10, 11, 12, 11, 10, 12, 11, 40, 2};
  constexpr std::array<float, 9> kClean = {10, 11, 12, 13, 14, 15, 16, 17, 18};
  EXPECT_EQ(keep(kGross, MismatchFilterMode::paper), (std::vector<char>{1, 1, 1, 1, 1, 1, 1, 0, 1}));
  EXPECT_EQ(keep(kClean, MismatchFilterMode::paper), (std::vector<char>{1, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(keep(kGross, MismatchFilterMode::adaptive), (std::vector<char>{1, 1, 1, 1, 1, 1, 1, 0, 0}));
  EXPECT_EQ(keep(kClean, MismatchFilterMode::adaptive), std::vector<char>(9, 1));
}

TEST(SlamChapters, Pose) {
  StereoCamera camera;
  camera.fx = camera.fy = 100.0;
  const auto row = [&](double depth) -> Eigen::Matrix<double, 1, 6> {
    const Eigen::Vector3d p(1.0, 0.0, depth);
    return pose_jacobian(projection_jacobian(camera, p, false), p).row(0);
  };
  Eigen::Matrix<double, 1, 6> expected;
  expected << 10.0, 0.0, -1.0, 0.0, 101.0, 0.0;
  EXPECT_TRUE(row(10.0).isApprox(expected, 1e-12)) << row(10.0);
  EXPECT_NEAR(0.1 * row(20.0)[0], 0.5, 1e-12);
  EXPECT_NEAR(0.01 * row(20.0)[4], 1.0, 0.01);
}

TEST(SlamChapters, BundleAdjustment) {
  const Eigen::Matrix<double, 3, 2> z{{10.0, 14.0}, {9.2, 12.9}, {8.0, 12.1}};
  Eigen::Vector3d c(0.0, 1.0, 2.0);
  Eigen::Vector2d X(10.0, 14.0);
  const auto errors = [&] {
    Eigen::Matrix<double, 3, 2> e;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 2; ++j) e(i, j) = X[j] - c[i] - z(i, j);
    }
    return e;
  };
  const Eigen::Matrix<double, 3, 2> e = errors();
  EXPECT_NEAR(e.squaredNorm(), 0.06, 1e-12);

  // The whole system, c2 c3 X1 X2, without elimination.
  Eigen::Matrix<double, 6, 4> J = Eigen::Matrix<double, 6, 4>::Zero();
  Eigen::Matrix<double, 6, 1> r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) {
      const int k = 2 * i + j;
      r[k] = e(i, j);
      if (i > 0) J(k, i - 1) = -1.0;
      J(k, 2 + j) = 1.0;
    }
  }
  const Eigen::Matrix4d H = J.transpose() * J;
  const Eigen::Vector4d g = J.transpose() * r;
  const Eigen::Matrix2d U = H.topLeftCorner<2, 2>(), V = H.bottomRightCorner<2, 2>(),
                        W = H.topRightCorner<2, 2>();
  EXPECT_TRUE(U.isApprox(2.0 * Eigen::Matrix2d::Identity()));
  EXPECT_TRUE(V.isApprox(3.0 * Eigen::Matrix2d::Identity()));
  EXPECT_TRUE(W.isApprox(Eigen::Matrix2d::Constant(-1.0)));
  EXPECT_TRUE(g.isApprox(Eigen::Vector4d(0.1, 0.1, -0.2, 0.0), 1e-9)) << g;

  const Eigen::Matrix2d S = U - W * V.inverse() * W.transpose();
  EXPECT_TRUE(S.isApprox(Eigen::Matrix2d{{4.0 / 3, -2.0 / 3}, {-2.0 / 3, 4.0 / 3}}));
  const Eigen::Vector2d right = -g.head<2>() + W * V.inverse() * g.tail<2>();
  EXPECT_TRUE(right.isApprox(Eigen::Vector2d::Constant(-1.0 / 30), 1e-9));
  const Eigen::Vector2d dx = S.inverse() * right;
  const Eigen::Vector2d dX = -V.inverse() * (g.tail<2>() + W.transpose() * dx);
  EXPECT_TRUE(dx.isApprox(Eigen::Vector2d(-0.05, -0.05), 1e-9));
  EXPECT_TRUE(dX.isApprox(Eigen::Vector2d(1.0 / 30, -1.0 / 30), 1e-9));
  Eigen::Vector4d both;
  both << dx, dX;
  EXPECT_TRUE(both.isApprox(-H.inverse() * g, 1e-9));

  c.tail<2>() += dx;
  X += dX;
  EXPECT_NEAR(errors().squaredNorm(), 0.0433, 1e-4);
}

}  // namespace
}  // namespace penumbra::slam
