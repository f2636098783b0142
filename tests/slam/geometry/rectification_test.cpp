#include "slam/geometry/rectification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

LensCamera lens(LensModel model) {
  LensCamera camera{300.0, 298.0, 160.0, 118.0, model, {}, 320, 240};
  camera.distortion = model == LensModel::equidistant ? std::vector<double>{-0.02, 0.01, -0.005, 0.001}
                                                      : std::vector<double>{-0.28, 0.07, 0.0002, 0.0001};
  return camera;
}

// Where a real lens sees a point in its own frame: the formulas of the header.
Eigen::Vector2d project(const LensCamera& c, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y, r = std::sqrt(r2);
  const std::vector<double>& k = c.distortion;
  double u = 0.0, v = 0.0;
  if (c.model == LensModel::equidistant) {
    const double t = std::atan(r), t2 = t * t;
    const double d = t * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
    u = r > 1e-12 ? x * d / r : x;
    v = r > 1e-12 ? y * d / r : y;
  } else {
    const double radial = 1.0 + r2 * (k[0] + r2 * k[1]);
    u = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
    v = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  }
  return {c.fx * u + c.cx, c.fy * v + c.cy};
}

// An image with a soft dot, and where it is.
ByteImage dot(const LensCamera& camera, const Eigen::Vector2d& at) {
  ByteImage image(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      image.at(x, y) = static_cast<std::uint8_t>(
          std::lrint(250.0 * std::exp(-(std::pow(x - at.x(), 2) + std::pow(y - at.y(), 2)) / 18.0)));
    }
  }
  return image;
}

Eigen::Vector2d centroid(const ByteImage& image) {
  double sum = 0.0;
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      sum += image.at(x, y);
      weighted += image.at(x, y) * Eigen::Vector2d(x, y);
    }
  }
  return weighted / sum;
}

class Rectification : public testing::TestWithParam<LensModel> {};

TEST_P(Rectification, PointsAppearWhereThePinholePairSeesThem) {
  const LensCamera left = lens(GetParam());
  LensCamera right = left;
  right.cx += 5.0;
  right.cy -= 3.0;
  const SE3 T_right_left{so3_exp({0.01, -0.02, 0.015}), {-0.11, 0.002, -0.001}};
  const StereoRectification r = rectify_stereo(left, right, T_right_left, "test");
  EXPECT_NEAR(r.camera.baseline, T_right_left.translation.norm(), 1e-12);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.0, 0.0, 2.0), {-0.5, 0.3, 2.5}, {0.6, -0.4, 3.0}}) {
    const ByteImage left_image = r.left.linear(dot(left, project(left, p)));
    const ByteImage right_image = r.right.linear(dot(right, project(right, T_right_left * p)));
    const Eigen::Vector3d expected = r.camera.project_stereo(r.R_rectified_left * p);
    const Eigen::Vector2d in_left = centroid(left_image), in_right = centroid(right_image);
    EXPECT_NEAR(in_left.x(), expected.x(), 0.15);
    EXPECT_NEAR(in_left.y(), expected.y(), 0.15);
    EXPECT_NEAR(in_right.x(), expected.z(), 0.15);
    EXPECT_NEAR(in_right.y(), expected.y(), 0.15);
  }
}

TEST_P(Rectification, OneLensIsUndistorted) {
  const LensCamera camera = lens(GetParam());
  const Undistortion u = undistort(camera, "test");
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.0, 0.0, 1.0), {-0.25, 0.2, 1.0}, {0.3, -0.2, 1.0}}) {
    const Eigen::Vector2d seen = centroid(u.remap.linear(dot(camera, project(camera, p))));
    EXPECT_LT((seen - u.camera.project(p)).norm(), 0.15);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Rectification,
                         testing::Values(LensModel::radial_tangential, LensModel::equidistant));

TEST(RectificationOfDepth, DoesNotMixDepthsAcrossAnEdge) {
  const Undistortion u = undistort(lens(LensModel::radial_tangential), "test");
  WordImage depth = WordImage::filled(320, 240, 1000);
  for (int y = 0; y < 240; ++y) std::fill_n(depth.row(y) + 160, 160, std::uint16_t{4000});
  const WordImage out = u.remap.nearest(depth);
  for (std::size_t i = 0; i < out.elements(); ++i) {
    const std::uint16_t d = out.data()[i];
    EXPECT_TRUE(d == 0 || d == 1000 || d == 4000) << d;
  }
}

TEST(RectificationWithoutDistortion, LeavesTheImagesAlone) {
  LensCamera camera = lens(LensModel::radial_tangential);
  camera.distortion.clear();
  const Undistortion u = undistort(camera, "test");
  EXPECT_TRUE(u.remap.is_identity());
  EXPECT_EQ(u.camera.fx, camera.fx);
  const ByteImage image = dot(camera, {100.0, 50.0});
  EXPECT_EQ(u.remap.linear(image).data(), image.data());
}

TEST(RectificationErrors, CamerasThatAreNoPairAreRefused) {
  const LensCamera left = lens(LensModel::radial_tangential);
  LensCamera right = left;
  const SE3 T{Eigen::Matrix3d::Identity(), {-0.1, 0.0, 0.0}};
  LensCamera thin = left;
  thin.height = 1;
  expect_error<InputError>([&] { rectify_stereo(thin, thin, T, "pair"); }, {"pair", "2 x 2", "320 x 1"});
  expect_error<InputError>([&] { undistort(thin, "lens"); }, {"lens", "2 x 2", "320 x 1"});
  right.width = 321;
  expect_error<InputError>([&] { rectify_stereo(left, right, T, "pair"); },
                           {"pair", "same size", "321 x 240"});
  right = lens(LensModel::equidistant);
  expect_error<InputError>([&] { rectify_stereo(left, right, T, "pair"); }, {"same distortion model"});
  for (const Eigen::Vector3d& t :
       {Eigen::Vector3d(0.1, 0.0, 0.0), {0.0, 0.0, 0.0}, {0.0, -0.1, 0.0}, {0.0, 0.0, -0.1}}) {
    expect_error<InputError>(
        [&] {
          rectify_stereo(left, left, {Eigen::Matrix3d::Identity(), t}, "pair");
        },
        {"pair", "to the right", "swapped"});
  }
}

}  // namespace
}  // namespace penumbra::slam
