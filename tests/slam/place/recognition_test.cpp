#include "slam/place/recognition.h"

#include <gtest/gtest.h>

#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// A map of the whole ring road, without drift.
class Recognition : public ::testing::Test {
 protected:
  Recognition() {
    for (int k = 0; k < test::FeatureWorld::kKeyframesPerLap; ++k) drive.add_keyframe(k);
    index.insert_all(map);
  }
  std::optional<VerifiedPlace> recognise(const FeatureView& features,
                                         const RecognitionSettings& settings = {}) const {
    return recognise_image(map, index, last(), features, 1, settings);
  }
  std::vector<KeyFrame*> last() const { return {map.keyframes().rbegin(), map.keyframes().rend()}; }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  test::DriftingDrive drive{world, map, Vector6d::Zero()};
  PlaceIndex index;
  std::vector<int> seen;
};

TEST_F(Recognition, FindsTheCameraAnywhereInTheMap) {
  for (const double steps : {3.3, 25.6, 50.5, 71.2, 97.8}) {
    SE3 T_cw = world.T_cw(steps);
    T_cw.translation.x() += 0.4;  // beside the road that was driven
    const std::optional<VerifiedPlace> place = recognise(*world.view(T_cw, 7, seen));
    ASSERT_TRUE(place) << steps;
    EXPECT_LT((place->T_cw.inverse().translation - T_cw.inverse().translation).norm(), 0.05) << steps;
    EXPECT_LT((place->T_cw * T_cw.inverse()).angle(), 0.005) << steps;
    EXPECT_GE(place->inliers, 40);
  }
}

TEST_F(Recognition, FindsTheLastKeyframesWithoutTheIndex) {
  const PlaceIndex empty;
  const auto near = recognise_image(map, empty, last(), *world.view(world.T_cw(98.4), 7, seen), 1);
  ASSERT_TRUE(near);
  EXPECT_GE(near->keyframe->id, 95);
  EXPECT_FALSE(recognise_image(map, empty, last(), *world.view(world.T_cw(50.0), 7, seen), 1));
}

TEST_F(Recognition, FindsNothingInAnotherWorld) {
  const test::FeatureWorld elsewhere(99);
  for (const double steps : {0.0, 33.0, 66.0}) {
    EXPECT_FALSE(recognise(*elsewhere.view(elsewhere.T_cw(steps), 7, seen))) << steps;
  }
}

// A lorry hides three quarters of the image, and of the rest every other feature is lost.
TEST_F(Recognition, DoesNotAskForWhatAnObjectHides) {
  const int border = 3 * world.camera().width / 4;
  const std::shared_ptr<FrameFeatures> view = world.view(world.T_cw(50.5), 7, seen);
  std::vector<char> hidden(static_cast<std::size_t>(view->size()), 0);
  for (int i = 0; i < view->size(); ++i) {
    if (view->keypoint(i).u < static_cast<float>(border) || i % 2 == 0)
      hidden[static_cast<std::size_t>(i)] = 1;
  }
  const FeatureView left(*view, hidden);
  RecognitionSettings settings;
  settings.last_keyframes = 0;
  settings.anywhere.fewest_inliers = 15;
  settings.anywhere.fewest_cells = 4;
  EXPECT_FALSE(recognise(left, settings));
  const SeenObject lorry{0, "truck", {-1.0, 0.0, 2.0}, {0, 0, border, world.camera().height}, false};
  const auto place = recognise_image(map, index, last(), left, 1, settings, {lorry});
  ASSERT_TRUE(place);
  EXPECT_LT((place->T_cw * world.T_cw(50.5).inverse()).translation.norm(), 0.1);
}

TEST_F(Recognition, FindsNothingInAnImageOrAMapWithoutFeatures) {
  EXPECT_FALSE(recognise(FrameFeatures{}));
  const Map empty(world.camera(), world.scales());
  EXPECT_FALSE(recognise_image(empty, PlaceIndex{}, {}, *world.view(SE3{}, 7, seen), 1));
}

}  // namespace
}  // namespace penumbra::slam
