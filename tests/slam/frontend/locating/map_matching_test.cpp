#include "slam/frontend/locating/map_matching.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "slam/map/map.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// A map of one keyframe, with a point for each of its stereo features, and a frame half a step further on.
class MapMatching : public ::testing::Test {
 protected:
  MapMatching() {
    const SE3 there = world.T_cw(3.0);
    auto features = world.view(there, 1, seen);
    KeyFrame* keyframe = map.add_keyframe(0, 0.0, there, features);
    for (int i = 0; i < features->size(); ++i) {
      if (!features->has_stereo(i)) continue;
      const Keypoint& k = features->keypoint(i);
      points.push_back(map.add_point(
          there.inverse() * world.camera().back_project(k.u, k.v, features->depth[std::size_t(i)]), keyframe,
          i));
    }
    frame.T_cw = world.T_cw(3.2);
    frame.features = world.view(frame.T_cw, 2, seen);
    frame.points.assign(static_cast<std::size_t>(frame.features->size()), nullptr);
    frame.aligned.assign(frame.points.size(), 0);
    frame.pyramid = &pyramid;
  }
  long shown() const {
    return std::count_if(frame.points.begin(), frame.points.end(), [](const MapPoint* p) { return p; });
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  ImagePyramid pyramid;  // without images: nothing is aligned
  std::vector<int> seen;
  std::vector<MapPoint*> points;
  Frame frame;
};

TEST_F(MapMatching, FindsThePointsWhereTheyProject) {
  const auto looked_for = match_map_points(world.camera(), map.scales(), points, 10.0F, frame);
  EXPECT_GT(looked_for.size(), points.size() / 2);
  EXPECT_LE(looked_for.size(), points.size());
  EXPECT_GT(shown(), static_cast<long>(looked_for.size()) / 2);
}

TEST_F(MapMatching, CountsWhatTheFrameShowsAlreadyOnce) {
  match_map_points(world.camera(), map.scales(), points, 10.0F, frame);
  const long before = shown();
  auto looked_for = match_map_points(world.camera(), map.scales(), points, 10.0F, frame);
  std::sort(looked_for.begin(), looked_for.end());
  EXPECT_EQ(std::adjacent_find(looked_for.begin(), looked_for.end()), looked_for.end());
  EXPECT_GE(shown(), before);
}

TEST_F(MapMatching, KeepsThePointsThatAgreeWithThePose) {
  match_map_points(world.camera(), map.scales(), points, 10.0F, frame);
  const std::vector<PoseObservation> observations =
      refine_observations(world.camera(), map.scales(), {}, frame);
  ASSERT_EQ(static_cast<long>(observations.size()), shown());
  const PoseEstimate estimate = optimize_pose(world.camera(), frame.T_cw, observations);
  const int kept = keep_agreeing(world.camera(), map.scales(), observations, estimate, frame);
  EXPECT_EQ(kept, estimate.inliers);
  EXPECT_EQ(kept, shown());
  EXPECT_LT((estimate.T_cw.inverse().translation - world.T_cw(3.2).inverse().translation).norm(), 0.1);
}

TEST_F(MapMatching, MeasuresLoosePointsOfFeaturesWithoutAMapPoint) {
  match_map_points(world.camera(), map.scales(), points, 10.0F, frame);
  const auto free = std::find(frame.points.begin(), frame.points.end(), nullptr) - frame.points.begin();
  const auto taken = std::find_if(frame.points.begin(), frame.points.end(), [](auto* p) { return p; }) -
                     frame.points.begin();
  ASSERT_LT(free, static_cast<long>(frame.points.size()));
  const Patch patch;
  const Eigen::Vector3d ahead = frame.T_cw.inverse() * Eigen::Vector3d(0.0, 0.0, 20.0);
  const std::vector<LoosePoint> loose = {{static_cast<int>(free), ahead, &patch, 20.0},
                                         {static_cast<int>(taken), ahead, &patch, 20.0}};
  const auto observations = refine_observations(world.camera(), map.scales(), loose, frame);
  ASSERT_EQ(static_cast<long>(observations.size()), shown() + 1);
  EXPECT_EQ(observations.back().point, ahead);
}

TEST_F(MapMatching, FindsNothingWithoutPointsOrFeatures) {
  EXPECT_TRUE(match_map_points(world.camera(), map.scales(), {}, 10.0F, frame).empty());
  EXPECT_EQ(shown(), 0);
  Frame empty;
  empty.features = std::make_shared<FrameFeatures>();
  empty.features->grid = FeatureGrid(empty.features->left.keypoints, 640, 480);
  empty.T_cw = frame.T_cw;
  empty.pyramid = &pyramid;
  EXPECT_FALSE(match_map_points(world.camera(), map.scales(), points, 10.0F, empty).empty());
  EXPECT_TRUE(refine_observations(world.camera(), map.scales(), {}, empty).empty());
}

}  // namespace
}  // namespace penumbra::slam
