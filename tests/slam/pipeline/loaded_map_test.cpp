// A map that was saved, and the camera comes again: whole runs through a made-up world, without images.
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/map/map_file.h"
#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using penumbra::test::expect_error;

// The map of half the ring road, from 0 to 50, is in the file. What is seen carries other noise every time.
class LoadedMap : public ::testing::Test {
 protected:
  LoadedMap() {
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    drive(slam, 0.0, 50.0);
    slam.finish();
    saved_keyframes = slam.map().keyframes().size();
    write_map(path, slam.map());
    truth.clear();
  }
  std::unique_ptr<Map> load() const { return read_map(path); }
  void drive(test::RecordedSlam& slam, double from, double to) {
    for (double steps = from; steps < to; steps += 1.0) {
      const SE3 T_cw = world.T_cw(steps);
      const int index = static_cast<int>(slam.results().size());
      truth.push_back({0.1 * index, T_cw.inverse()});
      slam.process(index, 0.1 * index, world.view(T_cw, ++noise, seen));
    }
  }
  double error(const test::RecordedSlam& slam, std::size_t frame) const {
    return (slam.trajectory()[frame].T_wc.translation - truth[frame].T_wc.translation).norm();
  }

  test::FeatureWorld world;
  SlamSettings settings;
  penumbra::test::TemporaryDirectory folder;
  std::filesystem::path path = folder / "ring.map";
  std::size_t saved_keyframes = 0;
  Trajectory truth;
  std::uint64_t noise = 0;
  std::vector<int> seen;
};

TEST_F(LoadedMap, IsFoundOnesWayInFromTheFirstFrameAndStaysAsItIs) {
  settings.localise = true;
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings, {}, load());
  drive(slam, 20.3, 40.0);
  drive(slam, 5.5, 15.0);  // carried elsewhere
  slam.finish();
  EXPECT_EQ(slam.lost(), 0);
  for (const std::size_t frame : {0U, 10U, 19U, 22U, 29U}) EXPECT_LT(error(slam, frame), 0.2) << frame;
  EXPECT_TRUE(slam.keyframe_trajectory().empty());
  write_map(folder / "after.map", slam.map());
  EXPECT_EQ(nn::read_file(path, ""), nn::read_file(folder / "after.map", ""));
}

TEST_F(LoadedMap, BeyondItsEndTheCameraIsLostUntilItComesBack) {
  settings.localise = true;
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings, {}, load());
  drive(slam, 80.0, 90.0);  // where nobody has been
  EXPECT_EQ(slam.lost(), 10);
  drive(slam, 30.0, 34.0);
  EXPECT_EQ(slam.lost(), 10);
  EXPECT_LT(error(slam, 12), 0.2);
  EXPECT_EQ(slam.map().keyframes().size(), saved_keyframes);
}

TEST_F(LoadedMap, IsGoneOnWith) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings, {}, load());
  drive(slam, 40.2, 70.0);
  slam.finish();
  EXPECT_EQ(slam.lost(), 0);
  EXPECT_LT(error(slam, 0), 0.2);
  EXPECT_LT(error(slam, 29), 0.5);
  EXPECT_EQ(slam.submaps().size(), 1U);
  EXPECT_FALSE(slam.keyframe_trajectory().empty());
  EXPECT_LT(slam.keyframe_trajectory().size(), slam.map().keyframes().size());
  write_map(path, slam.map());
  EXPECT_EQ(load()->keyframes().size(), slam.map().keyframes().size());
}

TEST_F(LoadedMap, IsTiedToWhatBeganElsewhere) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings, {}, load());
  drive(slam, 75.0, 118.0);  // from where nobody has been into the map's beginning
  slam.finish();
  ASSERT_EQ(slam.submaps().size(), 1U);
  ASSERT_FALSE(slam.loops().empty());
  EXPECT_TRUE(slam.loops().front().merged_submaps);
  EXPECT_TRUE(slam.loops().front().of_loaded_map);
  EXPECT_LT(error(slam, 42), 0.3);
  EXPECT_LT(error(slam, 10), 0.5);
}

TEST_F(LoadedMap, OfAnotherPyramidOrNoneIsRefused) {
  settings.orb.pyramid.levels = 4;
  expect_error<InputError>([&] { Slam(world.camera(), Sensor::stereo, settings, {}, load()); },
                           {"loaded map", "4 levels"});
  settings = {};
  settings.localise = true;
  expect_error<InputError>([&] { Slam(world.camera(), Sensor::stereo, settings); }, {"localisation", "none"});
  expect_error<InputError>(
      [&] {
        Slam(world.camera(), Sensor::stereo, settings, {},
             std::make_unique<Map>(world.camera(), world.scales()));
      },
      {"localisation", "an empty one"});
}

}  // namespace
}  // namespace penumbra::slam
