#include "slam/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "nn/base/error.h"
#include "slam/evaluation/rpe.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"
#include "tests/support/trajectories.h"

namespace penumbra::slam {
namespace {

using test::expect_error;
using test::path_through;

Trajectory straight(int frames, double step) {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < frames; ++i) positions.emplace_back(0.0, 0.0, step * i);
  return path_through(positions);
}

TEST(RelativePoseError, IsZeroForIdenticalTrajectoriesInAnyWorld) {
  const Trajectory reference = test::winding_trajectory(200);
  Similarity world;
  world.rotation = so3_exp({0.3, 1.0, -2.0});
  world.translation = {100.0, 5.0, -3.0};
  const Trajectory estimate = transformed(reference, world);
  for (const FramePairs& pairs : {pairs_by_frames(estimate, 3), pairs_by_metres(estimate, 20.0)}) {
    const RelativePoseErrors errors = relative_pose_errors(reference, estimate, pairs);
    ASSERT_FALSE(errors.translation.empty());
    EXPECT_LT(error_statistics(errors.translation).max, 1e-11);
    EXPECT_LT(error_statistics(errors.rotation).max, 1e-5);
  }
}

TEST(RelativePoseError, MeasuresAKnownStep) {
  const Trajectory reference = straight(2, 1.0);
  Trajectory estimate = reference;
  estimate[1].T_wc = {so3_exp({0.0, 0.1, 0.0}), {0.3, 0.0, 1.4}};
  const RelativePoseErrors errors = relative_pose_errors(reference, estimate, {{0, 1}});
  EXPECT_NEAR(errors.translation.at(0), 0.5, 1e-12);
  EXPECT_NEAR(errors.rotation.at(0), 0.1 * 180.0 / std::numbers::pi, 1e-10);
}

TEST(RelativePoseError, PairsAreConsecutive) {
  const Trajectory trajectory = straight(8, 1.0);
  EXPECT_EQ(pairs_by_frames(trajectory, 3), (FramePairs{{0, 3}, {3, 6}}));
  EXPECT_EQ(pairs_by_frames(trajectory, 7), (FramePairs{{0, 7}}));
  EXPECT_EQ(pairs_by_frames(trajectory, 8), FramePairs{});
  EXPECT_EQ(pairs_by_frames(trajectory, std::numeric_limits<int>::max()), FramePairs{});
  EXPECT_EQ(pairs_by_metres(trajectory, 2.5), (FramePairs{{3, 6}}));
  EXPECT_EQ(pairs_by_metres(trajectory, 100.0), FramePairs{});
  EXPECT_EQ(pairs_by_metres({}, 1.0), FramePairs{});
}

TEST(RelativePoseError, StepsThatAreNotPositiveAreRefused) {
  const Trajectory trajectory = straight(3, 1.0);
  expect_error<UsageError>([&] { pairs_by_frames(trajectory, 0); }, {"0 frames"});
  for (const double metres : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_error<UsageError>([&] { pairs_by_metres(trajectory, metres); }, {"more than 0"});
  }
}

TEST(KittiMetrics, APathScaledByOnePerCentDriftsOnePerCent) {
  const Trajectory reference = straight(1001, 1.0);
  Trajectory estimate = reference;
  for (TimedPose& pose : estimate) pose.T_wc.translation *= 1.01;
  const KittiMetrics metrics = kitti_metrics(reference, estimate);
  EXPECT_EQ(metrics.path_length, 1000.0);
  for (const SegmentDrift& drift : metrics.by_length) {
    // A segment of L metres ends at the first frame past L: here L + 1 metres.
    EXPECT_NEAR(drift.translation, (drift.length + 1.0) / drift.length, 1e-9) << drift.length;
    EXPECT_NEAR(drift.rotation, 0.0, 1e-9);
  }
  EXPECT_NEAR(metrics.overall.translation, 1.0, 0.01);
}

TEST(KittiMetrics, AConstantTurnDriftsAsItTurns) {
  // The estimate turns by 0.001 degrees a metre where the reference goes straight.
  const Trajectory reference = straight(1000, 1.0);
  Trajectory estimate = reference;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T_wc.rotation =
        so3_exp({0.0, 0.001 * static_cast<double>(i) * std::numbers::pi / 180.0, 0.0});
  }
  EXPECT_NEAR(kitti_metrics(reference, estimate, {500.0}).overall.rotation, 0.1 * 501 / 500, 1e-6);
}

TEST(KittiMetrics, CountsEveryTenthFrameAndEveryLength) {
  const Trajectory path = straight(101, 1.0);
  const KittiMetrics metrics = kitti_metrics(path, path, {50.0, 99.5, 100.0});
  // 50 m end at frame i + 51 <= 100: i = 0, 10, .., 40; 99.5 m only from frame 0; 100 m would need frame 101.
  EXPECT_EQ(metrics.by_length.at(0).count, 5);
  EXPECT_EQ(metrics.by_length.at(1).count, 1);
  EXPECT_EQ(metrics.by_length.at(2).count, 0);
  EXPECT_EQ(metrics.overall.count, 6);
  EXPECT_EQ(metrics.overall.translation, 0.0);
}

TEST(KittiMetrics, APathShorterThanEverySegmentHasNoDrift) {
  const KittiMetrics metrics = kitti_metrics(straight(50, 1.0), straight(50, 1.1));
  EXPECT_EQ(metrics.overall.count, 0);
  EXPECT_EQ(metrics.overall.translation, 0.0);
  EXPECT_EQ(kitti_metrics(straight(1, 1.0), straight(1, 1.0)).overall.count, 0);
}

TEST(KittiMetrics, LengthsThatAreNotPositiveAreRefused) {
  const Trajectory path = straight(50, 1.0);
  expect_error<UsageError>([&] { kitti_metrics(path, path, {}); }, {"at least one"});
  for (const double length : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_error<UsageError>([&] { kitti_metrics(path, path, {10.0, length}); }, {"more than 0"});
  }
}

// ORB-SLAM2's paper (Mur-Artal and Tardos 2017, table I) gives 0.70 % and 0.25 deg/100 m for KITTI 00.
TEST(KittiMetrics, MatchThePublishedDriftOfOrbSlam2) {
  PENUMBRA_REAL_DATA(reference, "kitti/poses/00.txt");
  PENUMBRA_REAL_DATA(estimate, "trajectories/KITTI_00_ORB.txt");
  const KittiMetrics metrics =
      kitti_metrics(read_kitti_trajectory(reference), read_kitti_trajectory(estimate));
  EXPECT_NEAR(metrics.overall.translation, 0.70, 0.005);
  EXPECT_NEAR(metrics.overall.rotation, 0.25, 0.005);
}

TEST(Association, TakesTheNearestWithinTheLimit) {
  Trajectory reference = straight(100, 1.0), estimate = straight(3, 1.0);
  for (TimedPose& pose : reference) pose.timestamp *= 0.01;
  estimate[0].timestamp = 0.104;  // nearest 0.10
  estimate[1].timestamp = 0.196;  // nearest 0.20
  estimate[2].timestamp = 5.0;    // none
  for (const bool swapped : {false, true}) {
    const TrajectoryPair pair =
        swapped ? associate_by_time(estimate, reference) : associate_by_time(reference, estimate);
    const Trajectory& matched = swapped ? pair.estimate : pair.reference;
    ASSERT_EQ(pair.reference.size(), 2U);
    ASSERT_EQ(pair.estimate.size(), 2U);
    EXPECT_DOUBLE_EQ(matched[0].timestamp, 0.10);
    EXPECT_DOUBLE_EQ(matched[1].timestamp, 0.20);
  }
}

TEST(Association, UsesEachPoseOnce) {
  Trajectory reference = straight(3, 1.0), estimate = straight(3, 1.0);
  estimate[0].timestamp = 0.996;
  estimate[1].timestamp = 0.999;  // the closest to 1
  estimate[2].timestamp = 1.002;
  const TrajectoryPair pair = associate_by_time(reference, estimate);
  ASSERT_EQ(pair.reference.size(), 1U);
  EXPECT_EQ(pair.reference[0].timestamp, 1.0);
  EXPECT_EQ(pair.estimate[0].timestamp, 0.999);
}

TEST(Association, WithoutACommonTimeIsRefused) {
  Trajectory late = straight(3, 1.0);
  for (TimedPose& pose : late) pose.timestamp += 100.0;
  expect_error<InputError>([&] { associate_by_time(straight(3, 1.0), late); },
                           {"within 0.01 s", "0.000..2.000 s", "100.000..102.000 s"});
  Trajectory near = straight(9, 1.0);
  for (TimedPose& pose : near) pose.timestamp += 0.2;
  expect_error<InputError>([&] { associate_by_time(straight(9, 1.0), near); }, {"--time-offset -0.200000 "});
  for (TimedPose& pose : near) pose.timestamp += 0.3;
  expect_error<InputError>([&] { associate_by_time(straight(9, 1.0), near); },
                           {"--time-offset -0.500000 or 0.500000"});
  expect_error<InputError>([&] { associate_by_time({}, late); }, {"no pose"});
  expect_error<InputError>([&] { associate_by_time({}, {}); }, {"no pose"});
}

TEST(Evaluation, IdenticalTrajectoriesHaveNoError) {
  const Trajectory trajectory = test::winding_trajectory(400);
  for (const Alignment alignment : {Alignment::none, Alignment::se3, Alignment::sim3}) {
    EvaluationOptions options;
    options.alignment = alignment;
    const Evaluation result = evaluate_trajectory(trajectory, trajectory, options);
    EXPECT_EQ(result.poses, 400);
    EXPECT_LT(result.ape.max, 1e-9);
    EXPECT_LT(result.rpe_frames.max, 1e-9);
    EXPECT_LT(result.rpe_metres.max, 1e-9);
    EXPECT_LT(result.kitti.overall.translation, 1e-9);
    EXPECT_GT(result.kitti.overall.count, 0);
  }
}

TEST(Evaluation, ASinglePoseIsEvaluatedWithoutRelativeErrors) {
  const Evaluation result = evaluate_trajectory(straight(1, 1.0), straight(1, 1.0));
  EXPECT_EQ(result.ape.count, 1);
  EXPECT_EQ(result.rpe_frames.count, 0);
  EXPECT_EQ(result.rpe_metres.count, 0);
  EXPECT_EQ(result.kitti.overall.count, 0);
}

}  // namespace
}  // namespace penumbra::slam
