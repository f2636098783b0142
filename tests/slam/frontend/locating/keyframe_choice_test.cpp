#include "slam/frontend/locating/keyframe_choice.h"

#include <gtest/gtest.h>

#include "slam/map/map.h"

namespace penumbra::slam {
namespace {

constexpr int kFeatures = 100;

// Half of them close, half of them far.
std::shared_ptr<FrameFeatures> features() {
  auto f = std::make_shared<FrameFeatures>();
  for (int i = 0; i < kFeatures; ++i) {
    f->left.keypoints.push_back({10.0F + static_cast<float>(i), 50.0F, 0, 0.0F, 1.0F});
    f->left.descriptors.push_back({static_cast<std::uint64_t>(i), 0, 0, 0});
    f->depth.push_back(i % 2 == 0 ? 8.0F : 80.0F);
    f->u_right.push_back(5.0F);
    f->colour.push_back({0, 0, 0});
  }
  f->grid = FeatureGrid(f->left.keypoints, 640, 480);
  return f;
}

class KeyframeChoice : public ::testing::Test {
 protected:
  KeyframeChoice() : keyframe(map.add_keyframe(0, 0.0, SE3{}, features())) {
    for (int i = 0; i < kFeatures; ++i) {
      const bool close = i % 2 == 0;
      map.add_point({0.1 * i, 0.0, close ? 8.0 : 80.0}, keyframe, i);
    }
  }
  // A frame that shows so many of the keyframe's close points, and of the far ones.
  Frame frame(int close, int far) const {
    Frame frame;
    frame.features = features();
    frame.points.assign(kFeatures, nullptr);
    for (int i = 0; i < kFeatures; ++i) {
      int& left = i % 2 == 0 ? close : far;
      if (left-- > 0)
        frame.points[static_cast<std::size_t>(i)] = keyframe->points[static_cast<std::size_t>(i)];
    }
    return frame;
  }
  bool becomes(const Frame& f, double seconds_since = 0.1) const {
    return becomes_keyframe(f, *keyframe, seconds_since, settings);
  }

  Map map{StereoCamera(), {1.0}};
  KeyFrame* keyframe;
  KeyframeSettings settings{
      .least_similarity = 0.4, .least_close_share = 0.3, .close_depth = 20.0, .longest_gap_seconds = 2.0};
};

TEST_F(KeyframeChoice, CountsWhatBothShow) {
  EXPECT_DOUBLE_EQ(similarity(frame(50, 50), *keyframe), 1.0);
  EXPECT_DOUBLE_EQ(similarity(frame(10, 20), *keyframe), 0.3);
  // Points of other keyframes say nothing about this one.
  KeyFrame* other = map.add_keyframe(1, 0.1, SE3{}, features());
  Frame f = frame(10, 20);
  f.points[99] = map.add_point({0.0, 0.0, 5.0}, other, 0);
  EXPECT_DOUBLE_EQ(similarity(f, *keyframe), 0.3);
}

TEST_F(KeyframeChoice, LeavesOutWhatTheMapKnows) {
  EXPECT_FALSE(becomes(frame(25, 25)));
  EXPECT_TRUE(becomes(frame(25, 10)));
  EXPECT_TRUE(becomes(frame(0, 0)));
}

TEST_F(KeyframeChoice, TakesAFrameThatLostTheClosePoints) {
  EXPECT_FALSE(becomes(frame(16, 50)));
  EXPECT_TRUE(becomes(frame(14, 50)));
  // Not where it has no others to offer: it would be a keyframe for nothing.
  Frame f = frame(14, 50);
  const auto without = features();
  for (int i = 0; i < kFeatures; i += 2) {
    if (f.points[static_cast<std::size_t>(i)] == nullptr) without->depth[static_cast<std::size_t>(i)] = -1.0F;
  }
  f.features = without;
  EXPECT_FALSE(becomes(f));
}

TEST_F(KeyframeChoice, DoesNotWaitForEver) {
  EXPECT_FALSE(becomes(frame(50, 50), 1.9));
  EXPECT_TRUE(becomes(frame(50, 50), 2.0));
}

TEST_F(KeyframeChoice, OfAKeyframeWithoutPointsIsYes) {
  KeyFrame* empty = map.add_keyframe(1, 0.1, SE3{}, features());
  EXPECT_DOUBLE_EQ(similarity(frame(50, 50), *empty), 0.0);
  EXPECT_TRUE(becomes_keyframe(frame(50, 50), *empty, 1, settings));
}

}  // namespace
}  // namespace penumbra::slam
