// Losing the way and finding it again: whole runs through a made-up world, without images.
#include <gtest/gtest.h>

#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"

namespace penumbra::slam {
namespace {

class Lost : public ::testing::Test {
 protected:
  // A frame at `steps` along the ring road; what a camera in the dark would see where `dark`.
  FrameResult show(test::RecordedSlam& slam, double steps, bool dark = false) {
    const SE3 T_cw = world.T_cw(steps);
    const int index = static_cast<int>(slam.results().size());
    std::shared_ptr<FrameFeatures> view = std::make_shared<FrameFeatures>();
    if (!dark) view = world.view(T_cw, static_cast<std::uint64_t>(index), seen);
    const double time = 0.1 * index + silence;
    truth.push_back({time, T_cw.inverse()});
    return slam.process(index, time, view);
  }
  void drive(test::RecordedSlam& slam, double from, double to, double step = 1.0) {
    for (double steps = from; steps < to; steps += step) show(slam, steps);
  }
  double error(const test::RecordedSlam& slam, std::size_t frame) const {
    return (slam.trajectory()[frame].T_wc.translation - truth[frame].T_wc.translation).norm();
  }

  test::FeatureWorld world;
  SlamSettings settings;
  Trajectory truth;
  std::vector<int> seen;
  double silence = 0.0;  // seconds that the stream had no frames, so far
};

TEST_F(Lost, ARingIsFollowedAndClosed) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 124.0);
  slam.finish();
  EXPECT_EQ(slam.lost(), 0);
  EXPECT_LT(error(slam, 50), 0.3);
  EXPECT_LT(error(slam, 114), 0.3);
  EXPECT_GE(slam.loops().size(), 1U);
  EXPECT_EQ(slam.submaps().size(), 1U);
}

TEST_F(Lost, FiveDarkFramesCostFiveFrames) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  for (int i = 0; i < 40; ++i) show(slam, i, i >= 20 && i < 25);
  EXPECT_EQ(slam.lost(), 5);
  EXPECT_FALSE(slam.results()[24].tracking.recovered);
  EXPECT_TRUE(slam.results()[25].tracking.recovered);
  EXPECT_LT(error(slam, 39), 0.2);
  EXPECT_LT(error(slam, 22), 1.0);  // the motion before carries on
  EXPECT_EQ(slam.submaps().size(), 1U);
}

TEST_F(Lost, AJumpBackToAPlaceOfLongAgoIsLocatedAtOnce) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 70.0);
  drive(slam, 20.3, 35.0);
  EXPECT_EQ(slam.lost(), 0);
  EXPECT_LT(error(slam, 70), 0.2);
  EXPECT_LT(error(slam, truth.size() - 1), 0.3);
  EXPECT_EQ(slam.submaps().size(), 1U);
}

// A stream that has no frames for 5 s: meanwhile the camera was carried back, drove on to where it had been
// before, or stood.
TEST_F(Lost, AfterASilenceOfTheStreamAKnownPlaceIsRecognised) {
  for (const double goes_on : {10.3, 25.0, 39.5}) {
    truth.clear();
    silence = 0.0;
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    drive(slam, 0.0, 40.0);
    silence = 5.0;
    drive(slam, goes_on, goes_on + 12.0);
    EXPECT_LE(slam.lost(), 1) << goes_on;
    EXPECT_LT(error(slam, truth.size() - 10), 0.3) << goes_on;
    EXPECT_LT(error(slam, truth.size() - 1), 0.3) << goes_on;
    EXPECT_EQ(slam.submaps().size(), 1U) << goes_on;
  }
}

TEST_F(Lost, AfterASilenceOfTheStreamNewGroundIsTiedToTheMapLater) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 25.0);
  silence = 5.0;  // in which it drove 35 m
  drive(slam, 60.0, 124.0);
  slam.finish();
  EXPECT_LE(slam.lost(), 5);
  ASSERT_EQ(slam.submaps().size(), 1U);
  EXPECT_LT(error(slam, 40), 0.3);
}

TEST_F(Lost, DoubleAndTripleStepAreFollowed) {
  for (const double step : {2.0, 3.0}) {
    truth.clear();
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    drive(slam, 0.0, 100.0, step);
    EXPECT_EQ(slam.lost(), 0) << step;
    EXPECT_LT(error(slam, truth.size() - 1), 0.5) << step;
  }
}

// After standing still no prediction leads to the next frame, and the last keyframe alone has made points.
TEST_F(Lost, AStepThatNobodyExpectsIsFollowed) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  for (int i = 0; i < 6; ++i) show(slam, 0.0);
  drive(slam, 3.0, 60.0, 3.0);
  EXPECT_EQ(slam.lost(), 0);
  EXPECT_EQ(slam.submaps().size(), 1U);
  EXPECT_LT(error(slam, truth.size() - 1), 0.5);
}

TEST_F(Lost, ANewPieceIsMergedWhenItComesToAKnownPlace) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 25.0);
  drive(slam, 60.0, 80.0);
  ASSERT_EQ(slam.submaps().size(), 2U);
  EXPECT_EQ(slam.lost(), 4);  // the fifth frame begins the new piece
  EXPECT_GT(error(slam, 40), 5.0);
  drive(slam, 80.0, 124.0);
  slam.finish();
  ASSERT_EQ(slam.submaps().size(), 1U);
  ASSERT_GE(slam.loops().size(), 1U);
  EXPECT_TRUE(slam.loops().front().merged_submaps);
  EXPECT_LT(error(slam, 40), 0.3);
  EXPECT_LT(error(slam, 20), 0.3);
}

TEST_F(Lost, APieceBeginsOnlyWhereFramesFollowFromEachOther) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 25.0);
  const std::vector<double> elsewhere = {55.0, 80.0, 60.0, 90.0, 70.0, 50.0, 75.0, 57.0};
  for (const double steps : elsewhere) show(slam, steps);
  EXPECT_EQ(slam.lost(), 8);
  EXPECT_EQ(slam.submaps().size(), 1U);
  drive(slam, 58.0, 64.0);
  slam.finish();
  EXPECT_EQ(slam.lost(), 9);  // the second that follows from the one before begins the new piece
  ASSERT_EQ(slam.submaps().size(), 2U);
  EXPECT_EQ(slam.submaps()[1].first_frame, 34);
}

TEST_F(Lost, APieceThatIsNeverTiedKeepsItsGuess) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 25.0);
  drive(slam, 55.0, 80.0);
  slam.finish();
  const std::vector<SubmapSummary> submaps = slam.submaps();
  ASSERT_EQ(submaps.size(), 2U);
  EXPECT_EQ(submaps[0].first_frame, 0);
  EXPECT_EQ(submaps[0].last_frame, 24);
  EXPECT_EQ(submaps[0].frames, 25);
  EXPECT_EQ(submaps[1].first_frame, 29);
  EXPECT_EQ(submaps[1].last_frame, 49);
  EXPECT_EQ(slam.trajectory().size(), 50U);
  // Nothing that was known before is lost, and the piece is right in itself.
  EXPECT_LT(error(slam, 20), 0.2);
  const Trajectory t = slam.trajectory();
  const SE3 moved = t[30].T_wc.inverse() * t[49].T_wc;
  const SE3 true_motion = truth[30].T_wc.inverse() * truth[49].T_wc;
  EXPECT_LT((moved.translation - true_motion.translation).norm(), 0.3);
}

TEST_F(Lost, EverythingRepeatsBitForBit) {
  std::vector<Trajectory> trajectories;
  for (const int threads : {1, 2}) {
    settings.threads = threads;
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    drive(slam, 0.0, 25.0);
    drive(slam, 60.0, 124.0);
    slam.finish();
    ASSERT_GE(slam.loops().size(), 1U);
    trajectories.push_back(slam.trajectory());
  }
  for (std::size_t i = 0; i < trajectories[0].size(); ++i) {
    ASSERT_EQ(trajectories[0][i].T_wc.translation, trajectories[1][i].T_wc.translation) << i;
    ASSERT_EQ(trajectories[0][i].T_wc.rotation, trajectories[1][i].T_wc.rotation) << i;
  }
}

}  // namespace
}  // namespace penumbra::slam
