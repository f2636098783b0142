// What a hypothesis that was not taken leaves behind: nothing. The second look at a located frame.
#include "slam/frontend/locating/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "nn/base/counter_random.h"
#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/frontend/locating/locating_scene.h"
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

// A frame of which every third feature alone is surely the world's.
class SecondLookTest : public test::LocatingScene {
 protected:
  // Locates a frame, and the one after it, which gets the second look.
  struct Located {
    Frame frame;
    TrackingReport report;
  };
  Located locate(const SecondLook& second_look) {
    frames = 0;
    Tracker tracker(map, index, settings, timer);
    Located located;
    for (int i = 0; i < 2; ++i) {
      located.frame = frame_at(world.T_cw(10.0 + 0.2 * i));
      std::vector<char>& movable = located.frame.movable;
      for (std::size_t k = 0; k < movable.size(); ++k) movable[k] = k % 3 != 0;
      located.report = tracker.track(located.frame, i == 0 ? SecondLook{} : second_look);
      EXPECT_EQ(located.report.state, TrackingState::tracking) << i;
    }
    return located;
  }
  static bool is_same_pose(const SE3& a, const SE3& b) {
    return a.rotation == b.rotation && a.translation == b.translation;
  }
  static void expect_unchanged(const Located& first, const Located& second) {
    EXPECT_FALSE(second.report.second_pose);
    EXPECT_TRUE(is_same_pose(first.frame.T_cw, second.frame.T_cw));
    EXPECT_EQ(first.frame.points, second.frame.points);
    EXPECT_EQ(first.frame.movable, second.frame.movable);
    EXPECT_EQ(first.report.map_inliers, second.report.map_inliers);
  }
  static int points_on(const Located& located, bool left_out_at_first) {
    int points = 0;
    for (std::size_t k = 0; k < located.frame.points.size(); ++k)
      points += located.frame.points[k] != nullptr && (k % 3 != 0) == left_out_at_first;
    return points;
  }
};

TEST_F(SecondLookTest, LocatesFromTheFirstPoseByWhatStandsAsWell) {
  const Located first = locate({});
  EXPECT_FALSE(first.report.second_pose);
  EXPECT_EQ(points_on(first, true), 0);
  int looks = 0;
  const Located second =
      locate([&](const SE3& T_cw, const FeaturePixels& pixels, std::vector<char>& movable) {
        ++looks;
        EXPECT_TRUE(is_same_pose(T_cw, first.frame.T_cw));
        EXPECT_EQ(pixels.size(), movable.size());
        for (std::size_t k = 1; k < movable.size(); k += 3) movable[k] = 0;  // the half of what was left out
        return true;
      });
  EXPECT_EQ(looks, 1);
  EXPECT_TRUE(second.report.second_pose);
  EXPECT_GT(second.report.second_look_ms, 0.0);
  EXPECT_FALSE(is_same_pose(first.frame.T_cw, second.frame.T_cw));
  const SE3 truth = world.T_cw(10.2);
  EXPECT_LT((second.frame.T_cw * truth.inverse()).translation.norm(), 0.05);
  // The world's points are kept, those that stand join, the others stay out.
  EXPECT_GE(points_on(second, false), points_on(first, false) * 9 / 10);
  EXPECT_GT(points_on(second, true), points_on(first, false) / 2);
  EXPECT_GT(second.report.map_inliers, first.report.map_inliers * 3 / 2);
  for (std::size_t k = 0; k < second.frame.points.size(); ++k) {
    EXPECT_EQ(second.frame.movable[k], k % 3 == 2) << k;
    if (k % 3 == 2) {
      EXPECT_EQ(second.frame.points[k], nullptr) << k;
    }
  }
}

TEST_F(SecondLookTest, TheFirstPoseStaysWhereNothingStands) {
  const Located first = locate({});
  expect_unchanged(first, locate([](const SE3&, const FeaturePixels&, std::vector<char>&) { return false; }));
}

TEST_F(SecondLookTest, TheFirstPoseStaysWhereTheSecondFails) {
  const Located first = locate({});
  // Nothing is left to locate the frame by.
  expect_unchanged(first, locate([](const SE3&, const FeaturePixels&, std::vector<char>& movable) {
                     movable.assign(movable.size(), 1);
                     return true;
                   }));
}

}  // namespace
}  // namespace penumbra::slam
