#include "slam/dynamics/dual_constraint.h"

#include <gtest/gtest.h>

#include <random>

#include "slam/geometry/fundamental.h"

namespace penumbra::slam {
namespace {

constexpr StereoCamera kKinect{525.0, 525.0, 319.5, 239.5, 0.08, 640, 480};

DualConstraintSettings settings_of(StaticPointMode mode) {
  DualConstraintSettings settings;
  settings.mode = mode;
  return settings;
}

MeasuredPoint seen(const Eigen::Vector3d& p) { return {kKinect.project(p), p.z(), 1.0}; }

// To the right by 0.2 m, and turned a little.
SE3 sideways() {
  Vector6d step;
  step << 0.2, 0.01, 0.02, 0.01, 0.03, 0.005;
  return SE3::exp(step);
}

TEST(DualConstraint, FiguresAreThoseOfTheDefinitions) {
  const SE3 T = sideways();
  const DualConstraint constraint(kKinect, T, settings_of(StaticPointMode::paper));
  // Points that stand still give F by the eight-point algorithm: another way to the same line.
  std::vector<PointPair> pairs;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d p(draw(random), draw(random), 3.0 + draw(random));
    pairs.push_back({kKinect.project(p), kKinect.project(T * p)});
  }
  const Eigen::Matrix3d F = *solve_fundamental(pairs);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(draw(random), draw(random), 3.0 + draw(random));
    const Eigen::Vector3d moved = p + 0.1 * Eigen::Vector3d(draw(random), draw(random), draw(random));
    const auto d = constraint.compare(seen(p), seen(T * moved));
    ASSERT_TRUE(d);
    EXPECT_NEAR(d->line, epipolar_distance(F, {kKinect.project(p), kKinect.project(T * moved)}), 1e-6);
    EXPECT_NEAR(d->shift, (kKinect.project(T * p) - kKinect.project(T * moved)).norm(), 1e-9);
    EXPECT_NEAR(*d->depth, std::abs((T * p).z() - (T * moved).z()), 1e-9);
  }
}

// The table of docs/dynamics/static-points.md.
TEST(DualConstraint, FollowsTheExampleOfTheDocuments) {
  Vector6d right = Vector6d::Zero();
  right[0] = -0.2;  // the camera went to the right
  const SE3 T = SE3::exp(right);
  const DualConstraint constraint(kKinect, T, settings_of(StaticPointMode::adaptive));
  const Eigen::Vector3d p(0.3, -0.2, 2.5);
  const auto expect = [&](const MeasuredPoint& now, double line, double shift, double depth, bool moves) {
    const auto d = constraint.compare(seen(p), now);
    EXPECT_NEAR(d->line, line, 0.05);
    EXPECT_NEAR(d->shift, shift, 0.05);
    EXPECT_NEAR(*d->depth, depth, 0.005);
    EXPECT_EQ(constraint.moves(*d), moves);
  };
  MeasuredPoint noisy = seen(T * p);
  noisy.pixel += Eigen::Vector2d(0.6, -0.5);
  noisy.depth += 0.02;
  expect(noisy, 0.5, 0.8, 0.02, false);
  expect(seen(T * (p - Eigen::Vector3d(0.0, 0.08, 0.0))), 16.8, 16.8, 0.0, true);
  expect(seen(1.12 * (T * p)), 0.0, 0.0, 0.30, true);
}

TEST(DualConstraint, TellsNoiseFromWhatLeavesTheLineAndFromWhatMovesAlongIt) {
  const SE3 T = sideways();
  const Eigen::Vector3d p(0.3, -0.2, 2.5);
  for (const StaticPointMode mode : {StaticPointMode::paper, StaticPointMode::adaptive}) {
    const DualConstraint constraint(kKinect, T, settings_of(mode));
    MeasuredPoint noisy = seen(T * p);
    noisy.pixel += Eigen::Vector2d(0.6, -0.5);
    noisy.depth += 0.02;
    EXPECT_FALSE(constraint.moves(*constraint.compare(seen(p), noisy)));
    const auto up = constraint.compare(seen(p), seen(T * (p + Eigen::Vector3d(0.0, 0.08, 0.0))));
    EXPECT_GT(up->line, 10.0);
    EXPECT_TRUE(constraint.moves(*up));
    // Along its ray in the second camera: no pixel moves, the line says nothing, the depth does.
    const Eigen::Vector3d q = T * p;
    const auto along = constraint.compare(seen(p), seen(1.12 * q));
    EXPECT_LT(along->line, 1e-6);
    EXPECT_LT(along->shift, 1e-6);
    EXPECT_NEAR(*along->depth, 0.12 * q.z(), 1e-9);
    EXPECT_TRUE(constraint.moves(*along));
  }
}

TEST(DualConstraint, WithoutMotionOfTheCameraThereIsNoLine) {
  const DualConstraint constraint(kKinect, SE3{}, settings_of(StaticPointMode::adaptive));
  const Eigen::Vector3d p(0.3, -0.2, 2.5);
  const auto still = constraint.compare(seen(p), seen(p));
  EXPECT_EQ(still->line, 0.0);
  EXPECT_EQ(still->shift_score, 0.0);
  const auto moved = constraint.compare(seen(p), seen(p + Eigen::Vector3d(0.05, 0.0, 0.0)));
  EXPECT_EQ(moved->line, 0.0);
  EXPECT_TRUE(constraint.moves(*moved));
}

TEST(DualConstraint, PointsWithoutDepthOrBehindTheCamera) {
  const SE3 T = sideways();
  const DualConstraint constraint(kKinect, T, settings_of(StaticPointMode::adaptive));
  const Eigen::Vector3d p(0.3, -0.2, 2.5);
  MeasuredPoint now = seen(T * p);
  now.depth = -1.0;
  const auto d = constraint.compare(seen(p), now);
  EXPECT_FALSE(d->depth);
  EXPECT_FALSE(constraint.moves(*d));
  Vector6d back;
  back << 0.0, 0.0, -5.0, 0.0, 0.0, 0.0;
  EXPECT_FALSE(
      DualConstraint(kKinect, SE3::exp(back), settings_of(StaticPointMode::adaptive)).compare(seen(p), now));
}

// With noise as the settings have it, few that stand still are lost; the share does not depend on the depth.
TEST(DualConstraint, LosesTheSameShareAtAllDepths) {
  const SE3 T = sideways();
  DualConstraintSettings settings = settings_of(StaticPointMode::adaptive);
  settings.pose_sigma = 0.0;  // the pose is exact
  const DualConstraint constraint(kKinect, T, settings);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> draw(-0.3, 0.3);
  for (const double z : {1.0, 2.0, 4.0, 7.0}) {
    int lost = 0;
    constexpr int kPoints = 4000;
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d p(draw(random) * z, draw(random) * z, z);
      const auto measure = [&](const Eigen::Vector3d& q) {
        MeasuredPoint m = seen(q);
        m.pixel += settings.pixel_sigma * Eigen::Vector2d(normal(random), normal(random));
        m.depth += q.z() * q.z() / (525.0 * 0.08) * settings.disparity_sigma * normal(random);
        return m;
      };
      const auto d = constraint.compare(measure(p), measure(T * p));
      lost += constraint.moves(*d);
    }
    EXPECT_LT(lost / static_cast<double>(kPoints), 0.08) << z << " m";
    EXPECT_GT(lost / static_cast<double>(kPoints), 0.01) << z << " m";
  }
}

}  // namespace
}  // namespace penumbra::slam
