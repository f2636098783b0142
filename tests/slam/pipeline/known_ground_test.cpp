// A camera that goes to and fro over the same ground all day: its map is as large as the ground.
#include <gtest/gtest.h>

#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

TEST(KnownGround, TeachesTheMapNothingHoweverLongItIsDriven) {
  constexpr int kPlaces = 24, kLaps = 6;
  constexpr double kSecondsAFrame = 0.4;  // a keyframe's longest gap is a dozen of them
  const test::FeatureWorld world;
  SlamSettings settings;
  settings.deterministic = true;
  Slam slam(world.camera(), Sensor::stereo, settings);
  std::vector<std::size_t> keyframes;  // after each lap
  int frame = 0, located = 0;
  for (int lap = 0; lap < kLaps; ++lap) {
    for (int k = 0; k < 2 * kPlaces; ++k, ++frame) {
      const int place = k < kPlaces ? k : 2 * kPlaces - 1 - k;
      std::vector<int> seen;
      const auto view = world.view(world.T_cw(0.25 * place), static_cast<std::uint64_t>(frame), seen);
      const FrameResult result = slam.process(frame, kSecondsAFrame * frame, view);
      located += result.tracking.state == TrackingState::tracking;
    }
    keyframes.push_back(slam.map().keyframes().size());
  }
  slam.finish();
  EXPECT_EQ(located, frame);
  EXPECT_GE(keyframes[0], 2U);
  EXPECT_EQ(keyframes.back(), keyframes[2]);
}

}  // namespace
}  // namespace penumbra::slam
