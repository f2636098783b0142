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
    frame.features = world.view(world.T_cw(3.2), 2, seen);
    frame.pyramid = &pyramid;
    found.begin(frame, nullptr);
    found.T_cw = world.T_cw(3.2);
  }
  void match() { match_map_points(world.camera(), map.scales(), points, 10.0F, frame, found); }
  std::vector<PoseObservation> refine() {
    return refine_observations(world.camera(), map.scales(), frame, found);
  }
  long shown() const {
    return std::count_if(found.points.begin(), found.points.end(), [](const MapPoint* p) { return p; });
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  ImagePyramid pyramid;  // without images: nothing is aligned
  std::vector<int> seen;
  std::vector<MapPoint*> points;
  Frame frame;
  Hypothesis found;
};

TEST_F(MapMatching, FindsThePointsWhereTheyProject) {
  match();
  EXPECT_GT(found.looked_for.size(), points.size() / 2);
  EXPECT_LE(found.looked_for.size(), points.size());
  EXPECT_GT(shown(), static_cast<long>(found.looked_for.size()) / 2);
}

TEST_F(MapMatching, CountsWhatTheFrameShowsAlreadyOnce) {
  match();
  const long before = shown();
  match();
  std::vector<MapPoint*> looked_for = found.looked_for;
  std::sort(looked_for.begin(), looked_for.end());
  EXPECT_EQ(std::adjacent_find(looked_for.begin(), looked_for.end()), looked_for.end());
  EXPECT_GE(shown(), before);
}

TEST_F(MapMatching, KeepsThePointsThatAgreeWithThePose) {
  match();
  const std::vector<PoseObservation> observations = refine();
  ASSERT_EQ(static_cast<long>(observations.size()), shown());
  const PoseEstimate estimate = optimize_pose(world.camera(), found.T_cw, observations);
  const int kept = keep_agreeing(world.camera(), map.scales(), observations, estimate, frame, found);
  EXPECT_EQ(kept, estimate.inliers);
  EXPECT_EQ(kept, shown());
  EXPECT_LT((estimate.T_cw.inverse().translation - world.T_cw(3.2).inverse().translation).norm(), 0.1);
}

TEST_F(MapMatching, MeasuresLoosePointsOfFeaturesWithoutAMapPoint) {
  match();
  const auto free = std::find(found.points.begin(), found.points.end(), nullptr) - found.points.begin();
  const auto taken = std::find_if(found.points.begin(), found.points.end(), [](auto* p) { return p; }) -
                     found.points.begin();
  ASSERT_LT(free, static_cast<long>(found.points.size()));
  const Patch patch;
  const Eigen::Vector3d ahead = found.T_cw.inverse() * Eigen::Vector3d(0.0, 0.0, 20.0);
  found.loose = {{static_cast<int>(free), ahead, &patch, 20.0},
                 {static_cast<int>(taken), ahead, &patch, 20.0}};
  const auto observations = refine();
  ASSERT_EQ(static_cast<long>(observations.size()), shown() + 1);
  EXPECT_EQ(observations.back().point, ahead);
}

TEST_F(MapMatching, FindsNothingWithoutPointsOrFeatures) {
  match_map_points(world.camera(), map.scales(), {}, 10.0F, frame, found);
  EXPECT_TRUE(found.looked_for.empty());
  EXPECT_EQ(shown(), 0);
  auto none = std::make_shared<FrameFeatures>();
  none->grid = FeatureGrid(none->left.keypoints, 640, 480);
  frame.features = none;
  const SE3 T_cw = found.T_cw;
  found.begin(frame, nullptr);
  found.T_cw = T_cw;
  match();
  EXPECT_FALSE(found.looked_for.empty());
  EXPECT_TRUE(refine().empty());
}

}  // namespace
}  // namespace penumbra::slam
