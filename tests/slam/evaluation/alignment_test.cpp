#include "slam/evaluation/alignment.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "slam/evaluation/ape.h"
#include "slam/evaluation/statistics.h"
#include "tests/support/expect_error.h"
#include "tests/support/trajectories.h"

namespace penumbra::slam {
namespace {

using test::expect_error;
using test::path_through;

Similarity some_similarity(double scale) {
  Similarity similarity;
  similarity.scale = scale;
  similarity.rotation = so3_exp({1.2, -0.4, 2.0});
  similarity.translation = {10.0, -20.0, 5.0};
  return similarity;
}

double rmse(const Trajectory& reference, const Trajectory& estimate) {
  return error_statistics(absolute_pose_errors(reference, estimate)).rmse;
}

TEST(Alignment, RecoversAKnownSimilarity) {
  const Trajectory estimate = test::winding_trajectory(100);
  const Similarity truth = some_similarity(1.7);
  const Similarity found = find_alignment(transformed(estimate, truth), estimate, Alignment::sim3);
  EXPECT_TRUE(found.is_unique);
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
  EXPECT_LT((found.translation - truth.translation).norm(), 1e-10);
}

TEST(Alignment, RigidAlignmentKeepsTheScale) {
  const Trajectory estimate = test::winding_trajectory(100);
  const Similarity rigid = some_similarity(1.0);
  Similarity found = find_alignment(transformed(estimate, rigid), estimate, Alignment::se3);
  EXPECT_LT((found.rotation - rigid.rotation).norm(), 1e-12);
  found = find_alignment(transformed(estimate, some_similarity(1.7)), estimate, Alignment::se3);
  EXPECT_EQ(found.scale, 1.0);
}

TEST(Alignment, NoOtherSimilarityFitsBetter) {
  const Trajectory reference = test::winding_trajectory(60);
  const Trajectory estimate = test::disturbed(transformed(reference, some_similarity(0.8)), 0.5, 0.1, 1);
  const Similarity best = find_alignment(reference, estimate, Alignment::sim3);
  const double smallest = rmse(reference, transformed(estimate, best));
  for (int i = 0; i < 7; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      Similarity other = best;
      if (i < 3) other.translation[i] += step;
      if (i >= 3 && i < 6) other.rotation = so3_exp(step * Eigen::Vector3d::Unit(i - 3)) * other.rotation;
      if (i == 6) other.scale += step;
      EXPECT_GT(rmse(reference, transformed(estimate, other)), smallest) << "parameter " << i;
    }
  }
}

TEST(Alignment, AMirroredPathIsTurnedAndNotMirrored) {
  const Trajectory reference = test::winding_trajectory(80);
  Trajectory mirrored = reference;
  for (TimedPose& pose : mirrored) pose.T_wc.translation.x() *= -1.0;
  const Similarity found = find_alignment(reference, mirrored, Alignment::se3);
  EXPECT_NEAR(found.rotation.determinant(), 1.0, 1e-12);
}

TEST(Alignment, NoneIsTheIdentity) {
  const Trajectory reference = test::winding_trajectory(10);
  const Similarity found =
      find_alignment(reference, transformed(reference, some_similarity(2.0)), Alignment::none);
  EXPECT_EQ(found.scale, 1.0);
  EXPECT_EQ(found.rotation, Eigen::Matrix3d::Identity());
  EXPECT_EQ(found.translation, Eigen::Vector3d::Zero());
}

TEST(Alignment, APlanarPathIsUnique) {
  const Trajectory reference = path_through({{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 3}});
  const Similarity truth = some_similarity(1.3);
  const Similarity found = find_alignment(transformed(reference, truth), reference, Alignment::sim3);
  EXPECT_TRUE(found.is_unique);
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
}

TEST(Alignment, AStraightPathTakesTheSmallestTurn) {
  const Trajectory along_z = path_through({{0, 0, 0}, {0, 0, 1}, {0, 0, 2.5}, {0, 0, 4}});
  const Trajectory along_x = path_through({{7, 0, 0}, {9, 0, 0}, {12, 0, 0}, {15, 0, 0}});
  Similarity found = find_alignment(along_x, along_z, Alignment::sim3);
  EXPECT_FALSE(found.is_unique);
  EXPECT_NEAR(found.scale, 2.0, 1e-12);
  EXPECT_LT(rmse(along_x, transformed(along_z, found)), 1e-12);
  EXPECT_LT((found.rotation - so3_exp({0, std::acos(0.0), 0})).norm(), 1e-12);
  found = find_alignment(along_z, along_z, Alignment::se3);
  EXPECT_LT((found.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(Alignment, OnePoseAndAPathThatStandsStillAreOnlyMoved) {
  for (const int poses : {1, 2, 5}) {
    const Trajectory still = path_through(std::vector<Eigen::Vector3d>(poses, {1, 2, 3}));
    Trajectory reference = test::winding_trajectory(poses);
    for (const Alignment alignment : {Alignment::se3, Alignment::sim3}) {
      const Similarity found = find_alignment(reference, still, alignment);
      EXPECT_FALSE(found.is_unique);
      EXPECT_EQ(found.scale, 1.0);
      EXPECT_EQ(found.rotation, Eigen::Matrix3d::Identity());
      EXPECT_TRUE(found.translation.allFinite());
      // The other way round: the reference stands still.
      EXPECT_TRUE(find_alignment(still, reference, alignment).translation.allFinite());
    }
  }
}

TEST(Alignment, DifferentLengthsAndNoPosesAreRefused) {
  const Trajectory two = test::winding_trajectory(2), three = test::winding_trajectory(3);
  expect_error<InputError>([&] { find_alignment(three, two, Alignment::se3); }, {"3 poses", "2 poses"});
  expect_error<InputError>([&] { find_alignment({}, {}, Alignment::none); }, {"at least 1", "found 0"});
  expect_error<InputError>([&] { absolute_pose_errors(three, two); }, {"3 poses", "2 poses"});
  expect_error<UsageError>([] { parse_alignment("affine"); }, {"affine", "none, se3 or sim3"});
  EXPECT_EQ(parse_alignment("sim3"), Alignment::sim3);
}

TEST(ErrorStatistics, AreTheTextbookOnes) {
  const ErrorStatistics s = error_statistics({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.sse, 30.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_EQ(s.min, 1.0);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_EQ(error_statistics({5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(error_statistics({}).count, 0);
}

}  // namespace
}  // namespace penumbra::slam
