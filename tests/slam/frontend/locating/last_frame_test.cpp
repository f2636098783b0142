#include "slam/frontend/locating/last_frame.h"

#include <gtest/gtest.h>

#include "slam/map/map.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

class LastFrameTest : public ::testing::Test {
 protected:
  LastFrameTest() : last(map) {
    frame.T_cw = world.T_cw(3.0);
    frame.features = world.view(frame.T_cw, 1, seen);
    frame.points.assign(static_cast<std::size_t>(frame.features->size()), nullptr);
    frame.pyramid = &pyramid;
  }
  int with_stereo() const {
    int count = 0;
    for (int i = 0; i < frame.features->size(); ++i) count += frame.features->has_stereo(i);
    return count;
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  ImagePyramid pyramid;  // without images: no patches
  std::vector<int> seen;
  Frame frame;
  LastFrame last;
};

TEST_F(LastFrameTest, IsEmptyBeforeTheFirst) {
  EXPECT_TRUE(last.empty());
  last.remember(frame);
  EXPECT_FALSE(last.empty());
}

TEST_F(LastFrameTest, PutsFeaturesWhereStereoSeesThem) {
  last.remember(frame);
  const std::vector<Projection> projections = last.project(frame.T_cw);
  ASSERT_GT(with_stereo(), 50);
  EXPECT_EQ(projections.size(), static_cast<std::size_t>(with_stereo()));
  for (const Projection& p : projections) {
    const Keypoint& k = frame.features->keypoint(p.source);
    EXPECT_NEAR(p.u, k.u, 1e-2);
    EXPECT_NEAR(p.v, k.v, 1e-2);
    EXPECT_EQ(p.level, k.level);
  }
}

TEST_F(LastFrameTest, PrefersTheMapAndLeavesOutWhatMoves) {
  KeyFrame* keyframe = map.add_keyframe(0, 0.0, frame.T_cw, frame.features);
  MapPoint* point = map.add_point({1.0, 2.0, 30.0}, keyframe, 0);
  frame.points[0] = point;
  frame.movable.assign(frame.points.size(), 0);
  frame.movable[1] = 1;
  last.remember(frame);
  EXPECT_EQ(last.map_point(0), point);
  EXPECT_EQ(*last.point(0), point->position);
  EXPECT_FALSE(last.point(1));
}

TEST_F(LastFrameTest, TakesWhatIsFoundOutLater) {
  last.remember(frame);
  ASSERT_TRUE(last.point(1));
  std::vector<char> movable(frame.points.size(), 0);
  movable[1] = 1;
  last.set_movable(frame.index + 1, movable);
  EXPECT_TRUE(last.point(1)) << "of another frame";
  last.set_movable(frame.index, {1});
  EXPECT_TRUE(last.point(1)) << "of another size";
  last.set_movable(frame.index, movable);
  EXPECT_FALSE(last.point(1));
  last.refresh();
  EXPECT_FALSE(last.point(1));
}

TEST_F(LastFrameTest, PutsFeaturesWhereTheirPatchesWereFound) {
  auto pixels = std::make_shared<FeaturePixels>();
  for (int i = 0; i < frame.features->size(); ++i) {
    pixels->push_back(FeatureView::measured_pixel(*frame.features, i));
    pixels->back().u += 0.25F;
  }
  frame.pixels = pixels;
  last.remember(frame);
  for (const Projection& p : last.project(frame.T_cw)) {
    EXPECT_NEAR(p.u, frame.features->keypoint(p.source).u + 0.25F, 1e-2);
  }
}

// The mapper has moved the keyframe and made a point of one of its features.
TEST_F(LastFrameTest, MovesAlongWithItsKeyframe) {
  frame.points[0] = nullptr;
  last.remember(frame);
  KeyFrame* keyframe = map.add_keyframe(0, 0.0, frame.T_cw, frame.features);
  last.set_keyframe(keyframe);
  MapPoint* point = map.add_point({1.0, 2.0, 30.0}, keyframe, 0);
  keyframe->T_cw.translation.x() += 0.25;
  last.refresh();
  EXPECT_NEAR((last.T_cw().translation - frame.T_cw.translation).x(), 0.25, 1e-12);
  EXPECT_EQ(last.map_point(0), point);
}

TEST_F(LastFrameTest, MatchesAnywhereInTheImage) {
  last.remember(frame);
  const SE3 T_cw = world.T_cw(3.5);
  std::vector<int> there;
  const auto features = world.view(T_cw, 2, there);
  const std::vector<PoseObservation> observations = last.match_anywhere(*features);
  EXPECT_GT(observations.size(), 50U);
  int agree = 0;
  for (const PoseObservation& o : observations) {
    agree += (world.camera().project(T_cw * o.point) - o.measurement.pixel.head<2>()).norm() < 4.0;
  }
  EXPECT_GT(agree, static_cast<int>(observations.size()) / 2);
}

}  // namespace
}  // namespace penumbra::slam
