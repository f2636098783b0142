#include "slam/backend/map_correction.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

constexpr int kRound = test::FeatureWorld::kKeyframesPerLap;

// A lap of the ring road, as a drifting odometry sees it, up to where it began.
class MapCorrectionTest : public ::testing::Test {
 protected:
  void drive_lap(double degrees) {
    Vector6d drift = Vector6d::Zero();
    drift[4] = degrees * std::numbers::pi / 180.0 / kRound;
    test::DriftingDrive drive(world, map, drift);
    for (int k = 0; k < kRound + 2; ++k) newest = drive.add_keyframe(k);
    first = map.keyframes().front();
  }
  VerifiedPlace recognised() const {
    const std::optional<VerifiedPlace> place = verify_place(map, newest->view(), first, 1, {});
    EXPECT_TRUE(place);
    return place.value_or(VerifiedPlace{});
  }
  // Metres, of the keyframe farthest from where it truly is.
  double largest_error() const {
    double largest = 0.0;
    for (const KeyFrame* k : map.keyframes()) {
      const SE3 truth = world.T_cw(k->frame_index);
      largest = std::max(largest, (k->T_cw.inverse().translation - truth.inverse().translation).norm());
    }
    return largest;
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  KeyFrame *newest = nullptr, *first = nullptr;
};

TEST_F(MapCorrectionTest, PutsTheKeyframeWhereThePlaceHasItAndSpreadsTheRest) {
  drive_lap(6.0);
  const double before = largest_error();
  ASSERT_GT(before, 1.0);
  const VerifiedPlace place = recognised();
  const int points = test::count_points(map);
  const MapCorrection correction = correct_map(map, newest, place, {}, {});
  EXPECT_FALSE(correction.merged_submaps);
  EXPECT_GT(correction.fused, 30);
  EXPECT_LT(test::count_points(map), points) << "what both visits saw is one by now";
  EXPECT_LT((newest->T_cw * place.T_cw.inverse()).translation.norm(), 0.05);
  EXPECT_LT(largest_error(), 0.3 * before);
  EXPECT_EQ(first->T_cw.translation, SE3{}.translation) << "the world's origin stays";
  const bool tied = std::any_of(newest->covisibles.begin(), newest->covisibles.end(),
                                [](const Covisible& c) { return c.keyframe->id < 10; });
  EXPECT_TRUE(tied) << "both visits are neighbours";
  for (const KeyFrame* k : map.keyframes()) EXPECT_TRUE(k->T_cw.is_finite());
}

// In the middle of the lap nothing was fused: every point stays where the keyframe that made it sees it.
TEST_F(MapCorrectionTest, MovesPointsAlongWithTheirKeyframes) {
  drive_lap(6.0);
  KeyFrame* middle = map.keyframes()[kRound / 2];
  std::vector<std::pair<const MapPoint*, Eigen::Vector3d>> seen;
  for (const MapPoint* point : middle->points) {
    if (point != nullptr && point->observations.front().keyframe == middle)
      seen.emplace_back(point, middle->T_cw * point->position);
  }
  ASSERT_FALSE(seen.empty());
  const SE3 T_before = middle->T_cw;
  correct_map(map, newest, recognised(), {}, {});
  EXPECT_GT((middle->T_cw * T_before.inverse()).translation.norm(), 0.1);
  for (const auto& [point, p] : seen) EXPECT_LT((middle->T_cw * point->position - p).norm(), 1e-9);
}

TEST_F(MapCorrectionTest, LeavesAMapThatIsRightAsItIs) {
  drive_lap(0.0);
  const double before = largest_error();
  ASSERT_LT(before, 0.01);
  correct_map(map, newest, recognised(), {}, {});
  EXPECT_LT(largest_error(), 0.1);
}

TEST_F(MapCorrectionTest, BringsAnotherSubmapHomeAsAWhole) {
  test::DriftingDrive drive(world, map, Vector6d::Zero());
  for (int k = 0; k < 10; ++k) drive.add_keyframe(k);
  first = map.keyframes()[5];
  drive.begin_submap();
  Vector6d guess = Vector6d::Zero();
  guess.head<3>() = Eigen::Vector3d(4.0, -1.0, 7.0);
  guess[4] = 0.4;
  drive.shift(guess);
  for (int k = 0; k < 6; ++k) newest = drive.add_keyframe(4.0 + k);
  ASSERT_EQ(newest->submap, 1);
  const VerifiedPlace place = recognised();
  const SE3 between = newest->T_cw * map.keyframes()[11]->T_cw.inverse();
  const MapCorrection correction = correct_map(map, newest, place, {}, {});
  EXPECT_TRUE(correction.merged_submaps);
  for (const KeyFrame* k : map.keyframes()) EXPECT_EQ(k->submap, 0);
  EXPECT_LT((newest->T_cw * world.T_cw(9.0).inverse()).translation.norm(), 0.1);
  const SE3 now = newest->T_cw * map.keyframes()[11]->T_cw.inverse();
  EXPECT_LT((now.translation - between.translation).norm(), 1e-9) << "it keeps its shape";
}

}  // namespace
}  // namespace penumbra::slam
