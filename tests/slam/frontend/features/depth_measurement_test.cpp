#include "slam/frontend/features/depth_measurement.h"

#include <gtest/gtest.h>

#include <limits>

namespace penumbra::slam {
namespace {

const StereoCamera kRgbdCamera{500.0, 500.0, 320.0, 240.0, 0.08, 640, 480};

Features features_at(std::initializer_list<std::pair<float, float>> pixels) {
  Features features;
  for (const auto& [u, v] : pixels) features.keypoints.push_back({u, v, 0, 0.0F, 0.0F});
  features.descriptors.resize(features.keypoints.size());
  return features;
}

TEST(DepthMeasurement, GivesTheColumnOfAVirtualRightCamera) {
  const FloatImage depth = FloatImage::filled(640, 480, 2.0F);
  StereoMatches matches;
  measure_depth(kRgbdCamera, features_at({{100.25F, 50.0F}, {400.0F, 300.5F}}), depth, matches);
  EXPECT_EQ(matches.count, 2);
  EXPECT_FLOAT_EQ(matches.depth[0], 2.0F);
  EXPECT_FLOAT_EQ(matches.u_right[0], 100.25F - 20.0F);  // fx b / Z = 20 pixels
  // It is what a point at that depth projects to.
  const Eigen::Vector3d pixel = kRgbdCamera.project_stereo(kRgbdCamera.back_project(400.0, 300.5, 2.0));
  EXPECT_NEAR(matches.u_right[1], pixel.z(), 1e-4);
}

TEST(DepthMeasurement, LeavesOutWhatIsUnknown) {
  FloatImage depth = FloatImage::filled(640, 480, 2.0F);
  depth.at(100, 50) = 0.0F;
  depth.at(100, 51) = std::numeric_limits<float>::quiet_NaN();
  depth.at(100, 52) = std::numeric_limits<float>::infinity();
  depth.at(100, 53) = -1.0F;
  StereoMatches matches;
  // The last two lie outside the image, and to the left of what the virtual camera sees.
  measure_depth(kRgbdCamera,
                features_at({{100, 50}, {100, 51}, {100, 52}, {100, 53}, {639.6F, 20}, {10, 20}}), depth,
                matches);
  EXPECT_EQ(matches.count, 0);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(matches.u_right[i], -1.0F) << i;
    EXPECT_EQ(matches.depth[i], -1.0F) << i;
  }
}

// A wall that stands askew, seen by a camera that has turned and gone on when it takes the depths.
TEST(DepthMeasurement, LooksWhereTheDepthCameraSawThePoint) {
  Vector6d motion;
  motion << 0.02, -0.01, 0.03, 0.01, 0.03, -0.02;
  const SE3 T_dc = SE3::exp(motion);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.5, 0.2, 1.0).normalized();  // of the wall, 2 m away
  const Eigen::Vector3d normal_d = T_dc.rotation * normal;
  const double distance_d = 2.0 + normal_d.dot(T_dc.translation);
  FloatImage depth = FloatImage::filled(640, 480, 0.0F);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      depth.at(u, v) = static_cast<float>(distance_d / normal_d.dot(kRgbdCamera.back_project(u, v, 1.0)));
    }
  }
  const Features features = features_at({{200, 100}, {320, 240}, {450.5F, 300.25F}});
  StereoMatches moved, at_once;
  measure_depth(kRgbdCamera, features, depth, moved, T_dc);
  measure_depth(kRgbdCamera, features, depth, at_once);
  ASSERT_EQ(moved.count, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const Keypoint& k = features.keypoints[i];
    const double truth = 2.0 / normal.dot(kRgbdCamera.back_project(k.u, k.v, 1.0));
    EXPECT_NEAR(moved.depth[i], truth, 0.003) << i;
    EXPECT_GT(std::abs(at_once.depth[i] - truth), 0.02) << i;
  }
  // A hole there stays one; one where the feature is now does not matter.
  depth.fill(0.0F);
  measure_depth(kRgbdCamera, features, depth, moved, T_dc);
  EXPECT_EQ(moved.count, 0);
}

TEST(DepthMeasurement, WithoutFeaturesThereIsNothing) {
  StereoMatches matches;
  matches.count = 5;
  measure_depth(kRgbdCamera, {}, FloatImage::filled(640, 480, 1.0F), matches);
  EXPECT_EQ(matches.count, 0);
  EXPECT_TRUE(matches.u_right.empty());
}

}  // namespace
}  // namespace penumbra::slam
