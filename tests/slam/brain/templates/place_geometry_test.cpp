#include "slam/brain/templates/place_geometry.h"

#include <gtest/gtest.h>

#include "tests/slam/feature_world.h"

namespace penumbra::slam::brain {
namespace {

class PlaceGeometry : public ::testing::Test {
 protected:
  PlaceGeometry() { settings.farthest = 200.0; }
  std::shared_ptr<FrameFeatures> view(double steps, std::uint64_t noise) const {
    std::vector<int> seen;
    return world.view(world.T_cw(steps), noise, seen);
  }
  std::vector<PlacePoint> place(double steps) const {
    return place_points(world.camera(), *view(steps, 1), settings);
  }
  std::optional<ProvenPlace> prove(const std::vector<PlacePoint>& points, const FrameFeatures& now,
                                   std::uint64_t seed = 5) const {
    return prove_place(world.camera(), points, now, world.scales(), seed, settings);
  }

  test::FeatureWorld world;
  PlaceGeometrySettings settings;
};

TEST_F(PlaceGeometry, FindsTheCameraAgainstThePlace) {
  const std::optional<ProvenPlace> found = prove(place(10.0), *view(10.8, 2));
  ASSERT_TRUE(found);
  const PlanePose true_motion = plane_pose(world.T_cw(10.0) * world.T_cw(10.8).inverse());
  EXPECT_NEAR(found->motion.x, true_motion.x, 0.05);
  EXPECT_NEAR(found->motion.y, true_motion.y, 0.05);
  EXPECT_NEAR(found->motion.heading, true_motion.heading, 0.01);
  EXPECT_GE(found->inliers, settings.fewest_inliers);
  EXPECT_GE(found->share, settings.least_share);
}

TEST_F(PlaceGeometry, AnotherPlaceIsNotProven) { EXPECT_FALSE(prove(place(10.0), *view(60.0, 2))); }

TEST_F(PlaceGeometry, NothingProvesNothing) {
  EXPECT_FALSE(prove({}, *view(10.0, 2)));
  EXPECT_FALSE(prove(place(10.0), FrameFeatures()));
  EXPECT_EQ(median_distance({}), 0.0);
  EXPECT_TRUE(place_points(world.camera(), FrameFeatures(), settings).empty());
}

TEST_F(PlaceGeometry, TheSameSeedProvesTheSame) {
  const std::vector<PlacePoint> points = place(10.0);
  const std::shared_ptr<FrameFeatures> now = view(10.5, 3);
  const std::optional<ProvenPlace> a = prove(points, *now, 9), b = prove(points, *now, 9);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->motion.x, b->motion.x);
  EXPECT_EQ(a->inliers, b->inliers);
}

TEST_F(PlaceGeometry, AMotionThatLeavesTheGroundIsRefused) {
  // The camera is 3 m higher now: no robot on the ground came there.
  SE3 up;
  up.translation = {0.0, 3.0, 0.0};
  std::vector<int> seen;
  const std::shared_ptr<FrameFeatures> above = world.view(up * world.T_cw(10.0), 2, seen);
  EXPECT_FALSE(prove(place(10.0), *above));
}

TEST_F(PlaceGeometry, KeepsTheNearestPoints) {
  settings.most_points = 20;
  const std::vector<PlacePoint> few = place(10.0);
  ASSERT_EQ(few.size(), 20U);
  settings.most_points = 1000;
  const std::vector<PlacePoint> all = place(10.0);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].position, all[i].position);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].position[2], all[i].position[2]);
  // The one in the middle, of the upper half where their number is even.
  EXPECT_EQ(median_distance(few), few[10].position[2]);
}

}  // namespace
}  // namespace penumbra::slam::brain
