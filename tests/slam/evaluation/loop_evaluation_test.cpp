#include "slam/evaluation/loop_evaluation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "nn/base/error.h"
#include "slam/evaluation/place_index_evaluation.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// Frame i has gone i metres along a circle of 100 m, heading along it (or backwards).
TimedPose on_circle(double metres, bool backwards = false) {
  const double angle = 2.0 * std::numbers::pi * metres / 100.0;
  const double radius = 50.0 / std::numbers::pi;
  SE3 T_wc;
  T_wc.rotation = Eigen::AngleAxisd(angle + (backwards ? std::numbers::pi : 0.0), Eigen::Vector3d::UnitY())
                      .toRotationMatrix();
  T_wc.translation = {radius * (1.0 - std::cos(angle)), 0.0, radius * std::sin(angle)};
  return {metres, T_wc};
}

Trajectory lap_and_more(int frames) {
  Trajectory truth;
  for (int i = 0; i < frames; ++i) truth.push_back(on_circle(i));
  return truth;
}

TEST(LoopEvaluation, FindsTheStretchThatIsDrivenTwice) {
  const std::vector<int> revisits = find_revisits(lap_and_more(130));
  EXPECT_EQ(revisits[94], -1);
  EXPECT_EQ(revisits[95], 0);  // 5 m before the start, 18 degrees off
  EXPECT_EQ(revisits[100], 0);
  EXPECT_EQ(revisits[129], 29);
  const std::vector<RevisitRegion> regions = find_regions(revisits);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].begin, 95);
  EXPECT_EQ(regions[0].end, 130);
  EXPECT_EQ(regions[0].earlier, 0);
}

TEST(LoopEvaluation, StandingStillAndTheOtherDirectionAreNoRevisits) {
  Trajectory waiting = lap_and_more(20);
  for (int i = 0; i < 200; ++i) waiting.push_back(waiting.back());
  for (const int revisit : find_revisits(waiting)) EXPECT_EQ(revisit, -1);
  Trajectory back = lap_and_more(80);
  for (int i = 79; i >= 0; --i) back.push_back(on_circle(i, true));
  for (const int revisit : find_revisits(back)) EXPECT_EQ(revisit, -1);
}

// Worked by hand: one region, 95 to 129. Of three loops one is right, one shows places 60 m apart, one was
// seen 40 frames before only. Keyframes 96, 106, 116, 126 are revisits; 106 and 116 are tied to the first
// lap.
TEST(LoopEvaluation, CountsLoopsRegionsAndKeyframes) {
  const std::vector<FramePair> loops = {{102, 3}, {110, 70}, {100, 60}};
  const std::vector<int> keyframes = {0, 6, 16, 60, 96, 106, 116, 126};
  const std::vector<FramePair> covisible = {{106, 96}, {106, 6}, {116, 16}, {126, 116}, {60, 16}};
  const LoopEvaluation result = evaluate_loops(lap_and_more(130), loops, keyframes, covisible);
  ASSERT_EQ(result.loops.size(), 3U);
  EXPECT_TRUE(result.loops[0].correct);
  EXPECT_NEAR(result.loops[0].distance, 1.0, 1e-3);
  EXPECT_FALSE(result.loops[1].correct);
  EXPECT_FALSE(result.loops[2].correct);
  EXPECT_NEAR(result.precision(), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(result.region_recall(), 1.0);
  EXPECT_EQ(result.revisited_keyframes, 4);
  EXPECT_EQ(result.tied_keyframes, 2);
  EXPECT_EQ(result.keyframe_recall(), 0.5);
  // Without the right loop the region stays open.
  EXPECT_EQ(evaluate_loops(lap_and_more(130), {{110, 70}}, {}, {}).region_recall(), 0.0);
}

// The same lap: of four proofs two are right; of keyframes 96, 106, 116 and 126 one is among their frames.
TEST(LoopEvaluation, CountsPlacesThatWereProven) {
  const std::vector<FramePair> proven = {{106, 6}, {103, 3}, {110, 70}, {100, 60}};
  const RecognitionEvaluation result =
      evaluate_recognition(lap_and_more(130), proven, {0, 6, 16, 60, 96, 106, 116, 126});
  EXPECT_EQ(result.places, 4);
  EXPECT_EQ(result.right_places, 2);
  EXPECT_EQ(result.precision(), 0.5);
  EXPECT_EQ(result.revisited_keyframes, 4);
  EXPECT_EQ(result.recognised_keyframes, 1);
  EXPECT_EQ(result.recall(), 0.25);
  EXPECT_EQ(evaluate_recognition(lap_and_more(60), {}, {0, 30}).precision(), 1.0);
}

TEST(LoopEvaluation, NothingToFindIsNothingMissed) {
  const LoopEvaluation result = evaluate_loops(lap_and_more(60), {}, {0, 30}, {});
  EXPECT_TRUE(result.regions.empty());
  EXPECT_EQ(result.precision(), 1.0);
  EXPECT_EQ(result.region_recall(), 1.0);
  EXPECT_EQ(result.keyframe_recall(), 1.0);
  EXPECT_TRUE(find_revisits({}).empty());
}

TEST(LoopEvaluation, RefusesFramesThatTheGroundTruthLacks) {
  EXPECT_THROW(evaluate_loops(lap_and_more(60), {{60, 0}}, {}, {}), InputError);
  EXPECT_THROW(evaluate_loops(lap_and_more(60), {{50, -1}}, {}, {}), InputError);
  EXPECT_THROW(evaluate_loops(lap_and_more(60), {}, {61}, {}), InputError);
}

// A lap and a half through the made-up world: 50 keyframes come by again, and the index knows them all.
TEST(PlaceIndexEvaluation, FindsEveryRevisitOfAWorldWithoutLookalikes) {
  const test::FeatureWorld world;
  Map map(world.camera(), world.scales());
  test::DriftingDrive drive(world, map, Vector6d::Zero());
  Trajectory truth;
  for (int k = 0; k < 150; ++k) {
    drive.forget();
    drive.add_keyframe(k);
    truth.push_back({0.1 * k, world.T_cw(k).inverse()});
  }
  const PlaceIndexEvaluation result = evaluate_place_index(map, truth, 0);
  EXPECT_EQ(result.queries, 100);
  EXPECT_GE(result.revisits, 50);
  EXPECT_LE(result.revisits, 56);
  ASSERT_EQ(result.recall_at.size(), 3U);
  EXPECT_GT(result.recall_at[0], 0.85);
  EXPECT_GE(result.recall_at[2], result.recall_at[0]);
  EXPECT_GT(result.recall_at_full_precision, 0.0);
  EXPECT_GT(result.average_precision, 0.85);
  EXPECT_GT(result.bytes, 0U);
  for (std::size_t i = 1; i < result.curve.size(); ++i) {
    EXPECT_LT(result.curve[i].threshold, result.curve[i - 1].threshold);
    EXPECT_GE(result.curve[i].recall, result.curve[i - 1].recall);
  }
  truth.pop_back();
  EXPECT_THROW(evaluate_place_index(map, truth, 0), InputError);
}

}  // namespace
}  // namespace penumbra::slam
