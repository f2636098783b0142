#include "slam/frontend/locating/by_place.h"

#include "tests/slam/frontend/locating/locating_scene.h"

namespace penumbra::slam {
namespace {

using ByPlace = test::LocatingScene;

TEST_F(ByPlace, FindsTheFrameAnywhereInTheMap) {
  settings.recognition.last_keyframes = 0;
  for (const double steps : {2.4, 8.0, 15.6}) {
    const SE3 truth = world.T_cw(steps);
    const Frame frame = frame_at(truth);
    locate_by_place(input(frame, world.T_cw(70.0)), found);
    ASSERT_TRUE(found.success) << steps;
    EXPECT_LT(error(found, truth), 0.03) << steps;
    EXPECT_EQ(found.pairs(), 0) << "the last frame was not asked";
    ASSERT_NE(found.reference, nullptr);
    EXPECT_NEAR(found.reference->id, steps, 4.0);
  }
}

TEST_F(ByPlace, ComparesTheNewestKeyframesBeforeTheIndexKnowsThem) {
  const PlaceIndex empty;
  const SE3 truth = world.T_cw(18.3);
  const Frame frame = frame_at(truth);
  const LocatingInput known = input(frame, world.T_cw(10.0));
  const LocatingInput in{frame, last, map, empty, settings, timer, known.predicted};
  locate_by_place(in, found);
  ASSERT_TRUE(found.success);
  EXPECT_LT(error(found, truth), 0.03);
}

// In a map that was loaded nothing is this run's: the reference says where the camera was.
TEST_F(ByPlace, ComparesTheReferenceInALoadedMap) {
  const PlaceIndex empty;
  const SE3 truth = world.T_cw(5.2);
  const Frame frame = frame_at(truth);
  LocatingInput in{frame, last, map, empty, settings, timer, truth};
  in.first_own_keyframe = map.next_keyframe_id();
  locate_by_place(in, found);
  EXPECT_FALSE(found.success) << "nothing to compare with";
  in.reference = map.keyframes()[5];
  locate_by_place(in, found);
  ASSERT_TRUE(found.success);
  EXPECT_LT(error(found, truth), 0.03);
}

TEST_F(ByPlace, FindsNothingInAPlaceThatTheMapDoesNotShow) {
  const Frame frame = frame_at(world.T_cw(60.0));
  locate_by_place(input(frame, world.T_cw(10.0)), found);
  EXPECT_FALSE(found.success);
  EXPECT_EQ(found.reference, reference) << "as it was";
}

}  // namespace
}  // namespace penumbra::slam
