// What a hypothesis that was not taken leaves behind: nothing.
#include <gtest/gtest.h>

#include <algorithm>

#include "nn/base/counter_random.h"
#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"

namespace penumbra::slam {
namespace {

// A lorry ahead: points that keep their place in the camera's frame, whatever the camera does.
void add_lorry(const StereoCamera& camera, FrameFeatures& view) {
  constexpr int kPoints = 90;
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    const auto uniform = [&](std::uint64_t k, double low, double high) {
      return low + (high - low) * counter_uniform(77, 8 * i + k);
    };
    const Eigen::Vector3d p(uniform(0, -1.2, 1.2), uniform(1, -1.3, 1.0), uniform(2, 6.0, 6.2));
    const Eigen::Vector3d pixel = camera.project_stereo(p);
    Descriptor descriptor{};
    for (std::uint64_t w = 0; w < descriptor.size(); ++w) descriptor[w] = counter_random(78, 8 * i + w);
    view.left.keypoints.push_back(
        {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 0, 0.0F, 1.0F});
    view.left.descriptors.push_back(descriptor);
    view.u_right.push_back(static_cast<float>(pixel.z()));
    view.depth.push_back(static_cast<float>(p.z()));
    view.colour.push_back({});
  }
  view.grid = FeatureGrid(view.left.keypoints, camera.width, camera.height);
}

// Keeps the first `count` features.
void keep_first(int count, FrameFeatures& view) {
  const auto cut = [&](auto& values) {
    values.resize(std::min(values.size(), static_cast<std::size_t>(count)));
  };
  cut(view.left.keypoints);
  cut(view.left.descriptors);
  cut(view.u_right);
  cut(view.depth);
  cut(view.colour);
}

// The last frame shows a lorry that is found to move, but too little of the map: no hypothesis holds.
TEST(Tracker, ALostFrameKeepsNothingOfTheHypotheses) {
  const test::FeatureWorld world;
  SlamSettings settings;
  settings.tracker.fewest_map_inliers = 80;
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  std::vector<int> seen;
  constexpr int kLast = 12;
  for (int i = 0; i <= kLast; ++i) {
    const auto view = world.view(world.T_cw(i), static_cast<std::uint64_t>(i), seen);
    if (i == kLast) keep_first(60, *view);
    if (i >= kLast - 1) add_lorry(world.camera(), *view);
    const FrameResult result = slam.process(i, 0.1 * i, view);
    if (i < kLast) {
      ASSERT_EQ(result.tracking.state, TrackingState::tracking) << i;
      continue;
    }
    EXPECT_EQ(result.tracking.state, TrackingState::lost);
    EXPECT_FALSE(result.tracking.mover);
    EXPECT_EQ(result.tracking.frame_matches, 0);
    EXPECT_EQ(result.tracking.frame_inliers, 0);
    EXPECT_EQ(result.tracking.filter.kept + result.tracking.filter.removed, 0);
    const std::vector<FrameView::Feature> features = slam.newest_view().features;
    ASSERT_EQ(static_cast<int>(features.size()), view->size());
    for (int k = 0; k < view->size(); ++k) {
      const FrameView::Feature& feature = features[static_cast<std::size_t>(k)];
      EXPECT_FALSE(feature.movable || feature.in_map) << k;
      EXPECT_EQ(feature.u, view->keypoint(k).u) << k;
    }
  }
  slam.finish();
  EXPECT_TRUE(slam.instances().empty());
}

}  // namespace
}  // namespace penumbra::slam
