#include "slam/dynamics/object_motion.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

double noise(std::uint64_t seed, std::uint64_t i) {
  return static_cast<double>(counter_random(seed, i) % 2001) / 1000.0 - 1.0;
}

// Points that moved with velocity `v` over half a second, with 0.1 m of noise; every `spoilt`-th elsewhere.
std::vector<PointDisplacement> points_with(const Eigen::Vector3d& v, int count, int spoilt = 0) {
  std::vector<PointDisplacement> points;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::uint64_t>(3 * i);
    PointDisplacement point;
    point.seconds = 0.5;
    point.covariance = 0.01 * Eigen::Matrix3d::Identity();
    point.metres = 0.5 * v + 0.1 * Eigen::Vector3d(noise(1, k), noise(1, k + 1), noise(1, k + 2));
    if (spoilt > 0 && i % spoilt == 0) point.metres += Eigen::Vector3d(3.0, -2.0, 5.0);
    points.push_back(point);
  }
  return points;
}

TEST(ObjectMotion, FindsTheVelocityDespiteForeignPoints) {
  const Eigen::Vector3d v(0.5, 0.0, -8.0);
  const auto found = estimate_velocity(points_with(v, 30, 4), {});
  ASSERT_TRUE(found);
  EXPECT_LT((found->metres_per_second - v).norm(), 0.15);
  EXPECT_LT(found->inliers, 25);
}

TEST(ObjectMotion, SaysWhatMovesAndWhatStands) {
  const ObjectMotionSettings settings;
  EXPECT_GT(moving_evidence(*estimate_velocity(points_with({0.0, 0.0, 8.0}, 20), settings), settings), 5.0);
  EXPECT_GT(moving_evidence(*estimate_velocity(points_with({1.4, 0.0, 0.0}, 20), settings), settings), 5.0);
  EXPECT_LT(moving_evidence(*estimate_velocity(points_with({0.0, 0.0, 0.0}, 20), settings), settings), -2.0);
}

TEST(ObjectMotion, KnowsWhatItDoesNotKnow) {
  const ObjectMotionSettings settings;
  ObjectVelocity vague;
  vague.metres_per_second = {0.0, 0.0, 4.0};
  vague.covariance = 25.0 * Eigen::Matrix3d::Identity();
  EXPECT_LT(std::abs(moving_evidence(vague, settings)), 1.5);
}

TEST(ObjectMotion, NeedsPointsThatAgree) {
  EXPECT_FALSE(estimate_velocity({}, {}));
  EXPECT_FALSE(estimate_velocity(points_with({1.0, 0.0, 0.0}, 3), {}));
  std::vector<PointDisplacement> wild = points_with({0.0, 0.0, 0.0}, 12);
  for (std::size_t i = 0; i < wild.size(); ++i)
    wild[i].metres = 10.0 * Eigen::Vector3d(noise(2, i), noise(3, i), noise(4, i));
  EXPECT_FALSE(estimate_velocity(wild, {}));
}

}  // namespace
}  // namespace penumbra::slam
