#include "slam/place/place_verifier.h"

#include <gtest/gtest.h>

#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// Some keyframes of the ring road, and an image taken between two of them.
class PlaceVerifier : public ::testing::Test {
 protected:
  PlaceVerifier() {
    test::DriftingDrive drive(world, map, Vector6d::Zero());
    for (int k = 0; k < 20; ++k) drive.add_keyframe(k);
    keyframe = map.keyframes()[10];
    keyframe->objects = {{0, "car", {-3.5, 1.0, 6.0}, {}, true},
                         {1, "sign", {4.0, -1.0, 9.0}, {}, true},
                         {2, "car", {4.0, 1.0, 14.0}, {}, true},
                         {3, "car", {-4.0, 1.0, 23.0}, {}, true}};
    for (SeenObject object : keyframe->objects) {
      object.number += 100;
      object.position = T_cw * (keyframe->T_cw.inverse() * object.position);
      objects.push_back(object);
    }
  }

  // The image, of which an occluder leaves `most` features all over it.
  FrameFeatures image(int most) const {
    std::vector<int> seen;
    const std::shared_ptr<FrameFeatures> all = world.view(T_cw, 5, seen);
    if (most >= all->size()) return *all;
    FrameFeatures left;
    for (int n = 0; n < most; ++n) {
      const auto i = static_cast<std::size_t>(n) * static_cast<std::size_t>(all->size()) /
                     static_cast<std::size_t>(most);
      left.left.keypoints.push_back(all->left.keypoints[i]);
      left.left.descriptors.push_back(all->left.descriptors[i]);
      left.u_right.push_back(all->u_right[i]);
      left.depth.push_back(all->depth[i]);
    }
    left.colour.assign(left.left.keypoints.size(), {});
    left.grid = FeatureGrid(left.left.keypoints, world.camera().width, world.camera().height);
    return left;
  }

  std::optional<VerifiedPlace> verify(const FrameFeatures& features, const Constellation& around,
                                      const PlaceVerifierSettings& settings = {}) const {
    return verify_place(map, features, keyframe, 1, settings, around);
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  const SE3 T_cw = world.T_cw(10.3);
  KeyFrame* keyframe = nullptr;
  Constellation objects;  // around the image
};

TEST_F(PlaceVerifier, NeedsManyPointsWhereThereAreNoObjects) {
  EXPECT_TRUE(verify(image(1000000), {}));
  EXPECT_FALSE(verify(image(36), {}));
}

TEST_F(PlaceVerifier, NeedsFewerWhereTheSameObjectsStandAround) {
  const std::optional<VerifiedPlace> place = verify(image(36), objects);
  ASSERT_TRUE(place);
  EXPECT_EQ(place->objects, 4);
  EXPECT_GE(place->inliers, 20);
  EXPECT_LT(place->inliers, 40);
  EXPECT_LT((place->T_cw * T_cw.inverse()).translation.norm(), 0.1);
}

TEST_F(PlaceVerifier, NeverDoesWithFewerThanDetermineThePose) { EXPECT_FALSE(verify(image(16), objects)); }

TEST_F(PlaceVerifier, FindsTheSameWherePointsAreEnough) {
  const FrameFeatures all = image(1000000);
  const std::optional<VerifiedPlace> without = verify(all, {}), with = verify(all, objects);
  ASSERT_TRUE(without && with);
  EXPECT_EQ(with->objects, 0);
  EXPECT_EQ(with->inliers, without->inliers);
  EXPECT_EQ(with->points, without->points);
  EXPECT_EQ(with->T_cw.translation, without->T_cw.translation);
  EXPECT_EQ(with->T_cw.rotation, without->T_cw.rotation);
}

TEST_F(PlaceVerifier, IsNotHelpedByObjectsThatStandElsewhereOrMayMove) {
  Constellation elsewhere = objects, suspected = objects;
  for (SeenObject& object : elsewhere) object.position.z() += 5.0;
  EXPECT_FALSE(verify(image(36), elsewhere));
  for (SeenObject& object : suspected) object.stands = false;
  EXPECT_FALSE(verify(image(36), suspected));
}

// A lorry ahead hides the left half of the image: what is behind it cannot be asked for.
TEST_F(PlaceVerifier, DoesNotAskForPointsBehindWhatMayHaveCome) {
  const FrameFeatures all = image(1000000);
  const std::optional<VerifiedPlace> open = verify(all, {});
  ASSERT_TRUE(open);
  SeenObject lorry{
      7, "truck", {-2.0, 0.0, 4.0}, {0, 0, world.camera().width / 2, world.camera().height}, false};
  const std::optional<VerifiedPlace> behind = verify(all, {lorry});
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->inliers, open->inliers);
  EXPECT_LT(behind->visible, 3 * open->visible / 4);
  EXPECT_GT(behind->visible, open->visible / 4);
  lorry.stands = true;  // it stood there before, and hid the same
  EXPECT_EQ(verify(all, {lorry})->visible, open->visible);
  lorry.stands = false;
  lorry.position.z() = 1000.0;
  EXPECT_EQ(verify(all, {lorry})->visible, open->visible);
}

TEST_F(PlaceVerifier, CanDoWithoutConstellations) {
  PlaceVerifierSettings settings;
  settings.constellation.enabled = false;
  EXPECT_FALSE(verify(image(36), objects, settings));
}

}  // namespace
}  // namespace penumbra::slam
