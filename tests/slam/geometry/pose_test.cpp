#include <gtest/gtest.h>

#include <limits>

#include "slam/geometry/p3p.h"
#include "slam/geometry/pnp_ransac.h"
#include "slam/geometry/pose_optimizer.h"
#include "slam/geometry/reprojection.h"
#include "slam/geometry/triangulation.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

using test::random_motion;
using test::test_camera;
using test::visible_points;

std::vector<PoseObservation> observe(const StereoCamera& camera, const SE3& T_cw,
                                     const std::vector<Eigen::Vector3d>& points) {
  std::vector<PoseObservation> observations;
  for (std::size_t i = 0; i < points.size(); ++i) {
    observations.push_back({points[i], {camera.project_stereo(T_cw * points[i]), 1.0, i % 3 != 0}});
  }
  return observations;
}

// Every fourth observation is somewhere else.
void spoil(std::vector<PoseObservation>& observations) {
  for (std::size_t i = 0; i < observations.size(); i += 4) {
    observations[i].measurement.pixel += Eigen::Vector3d(60.0, -35.0 + double(i % 7), 40.0);
  }
}

double difference(const SE3& a, const SE3& b) { return (a * b.inverse()).log().norm(); }

TEST(Reprojection, JacobiansMatchNumericDerivatives) {
  const StereoCamera camera = test_camera();
  const SE3 T_cw = random_motion(1, 0.5, 0.1);
  const double h = 1e-6;
  for (const Eigen::Vector3d& X : visible_points(camera, 20, 2)) {
    for (const bool stereo : {false, true}) {
      const PixelMeasurement z{{100.0, 50.0, 80.0}, 1.0, stereo};
      const auto error = [&](const SE3& T, const Eigen::Vector3d& point) {
        return reprojection_error(camera, T * point, z);
      };
      const Eigen::Vector3d p = T_cw * X;
      const Eigen::Matrix3d J_pi = projection_jacobian(camera, p, stereo);
      const Eigen::Matrix<double, 3, 6> J_pose = pose_jacobian(J_pi, p);
      const Eigen::Matrix3d J_point = J_pi * T_cw.rotation;
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = h * Vector6d::Unit(k);
        const Eigen::Vector3d numeric =
            (error(SE3::exp(step) * T_cw, X) - error(SE3::exp(-step) * T_cw, X)) / (2.0 * h);
        EXPECT_LT((J_pose.col(k) - numeric).norm(), 1e-4 * (1.0 + numeric.norm()));
      }
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
        const Eigen::Vector3d numeric = (error(T_cw, X + step) - error(T_cw, X - step)) / (2.0 * h);
        EXPECT_LT((J_point.col(k) - numeric).norm(), 1e-4 * (1.0 + numeric.norm()));
      }
    }
  }
}

TEST(Huber, IsSmoothAtItsBound) {
  const double bound = 5.991;
  EXPECT_NEAR(huber(bound - 1e-9, bound).cost, huber(bound + 1e-9, bound).cost, 1e-7);
  EXPECT_NEAR(huber(bound - 1e-9, bound).weight, huber(bound + 1e-9, bound).weight, 1e-7);
  EXPECT_NEAR(huber(100.0, bound).weight, (huber(100.001, bound).cost - huber(99.999, bound).cost) / 0.002,
              1e-6);
}

TEST(Triangulation, FindsThePointThatTwoViewsSee) {
  const StereoCamera camera = test_camera();
  const SE3 a = random_motion(3, 0.1, 0.05), b = random_motion(4, 1.0, 0.05);
  int found = 0;
  for (const Eigen::Vector3d& X : visible_points(camera, 50, 5)) {
    const std::array<View, 2> views = {View{a, camera.project(a * X)}, View{b, camera.project(b * X)}};
    const auto point = triangulate(camera, views);
    if (!point) continue;
    ++found;
    EXPECT_LT((*point - X).norm(), 1e-5);
    EXPECT_LT(squared_epipolar_distance(fundamental_matrix(camera, a, b), views[0].pixel, views[1].pixel),
              1e-12);
  }
  EXPECT_EQ(found, 50);
}

TEST(Triangulation, RefusesParallelRaysAndPointsBehindACamera) {
  const StereoCamera camera = test_camera();
  const std::array<View, 2> same = {View{SE3{}, {300.0, 100.0}}, View{SE3{}, {300.0, 100.0}}};
  EXPECT_FALSE(triangulate(camera, same).has_value());
  EXPECT_FALSE(triangulate(camera, {}).has_value());
  SE3 right;
  right.translation.x() = -1.0;
  // The rays meet behind the cameras.
  const std::array<View, 2> apart = {View{SE3{}, {300.0, 100.0}}, View{right, {350.0, 100.0}}};
  EXPECT_FALSE(triangulate(camera, apart).has_value());
}

TEST(RealRoots, OfPolynomialsWithKnownRoots) {
  // (x - 1)(x + 2)(x - 3)(x - 0.5) = x^4 - 2.5 x^3 - 4 x^2 + 8.5 x - 3
  ShortList<double, 4> roots = real_roots({-3.0, 8.5, -4.0, -2.5, 1.0});
  std::sort(roots.begin(), roots.end());
  ASSERT_EQ(roots.size(), 4U);
  const std::vector<double> expected = {-2.0, 0.5, 1.0, 3.0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(roots[i], expected[i], 1e-10);
  EXPECT_EQ(real_roots({1.0, 0.0, 1.0, 0.0, 0.0}).size(), 0U);
  EXPECT_EQ(real_roots({}).size(), 0U);
  ASSERT_EQ(real_roots({-6.0, 3.0, 0.0, 0.0, 0.0}).size(), 1U);
  EXPECT_TRUE(real_roots({std::numeric_limits<double>::quiet_NaN(), 1.0, 0.0, 0.0, 0.0}).empty());
}

TEST(P3P, OneOfTheSolutionsIsThePose) {
  const StereoCamera camera = test_camera();
  int solved = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = random_motion(trial, 0.8, 0.3);
    const std::vector<Eigen::Vector3d> seen = visible_points(camera, 3, 1000 + trial);
    std::array<Eigen::Vector3d, 3> points, rays;
    for (std::size_t i = 0; i < 3; ++i) {
      points[i] = truth.inverse() * seen[i];
      rays[i] = seen[i].normalized();
    }
    double best = 1.0;
    for (const SE3& pose : solve_p3p(points, rays)) best = std::min(best, difference(pose, truth));
    solved += best < 1e-5;
  }
  EXPECT_GE(solved, kTrials - 2);
}

TEST(P3P, HasNoSolutionForDegeneratePoints) {
  const Eigen::Vector3d a(0.0, 0.0, 5.0), b(1.0, 0.0, 5.0), c(2.0, 0.0, 5.0);
  EXPECT_TRUE(solve_p3p({a, b, c}, {a.normalized(), b.normalized(), c.normalized()}).empty());
  EXPECT_TRUE(solve_p3p({a, a, b}, {a.normalized(), a.normalized(), b.normalized()}).empty());
}

TEST(PnpRansac, FindsThePoseAmongManyOutliersAndRepeatsExactly) {
  const StereoCamera camera = test_camera();
  const SE3 truth = random_motion(5, 2.0, 0.4);
  std::vector<Eigen::Vector3d> points = visible_points(camera, 200, 6);
  for (Eigen::Vector3d& p : points) p = truth.inverse() * p;
  std::vector<PoseObservation> observations = observe(camera, truth, points);
  for (std::size_t i = 0; i < observations.size(); i += 2) {
    observations[i].measurement.pixel = {double((i * 97) % 1241), double((i * 31) % 376),
                                         double((i * 57) % 1241)};
  }
  const auto first = solve_pnp_ransac(camera, observations, {}),
             second = solve_pnp_ransac(camera, observations, {});
  ASSERT_TRUE(first.has_value());
  EXPECT_LT(difference(first->T_cw, truth), 1e-4);
  EXPECT_GE(first->inliers, 100);
  EXPECT_EQ(first->T_cw.translation, second->T_cw.translation);
  EXPECT_EQ(first->inlier, second->inlier);
}

TEST(PnpRansac, GivesUpOnNoiseAndOnTooFewPoints) {
  const StereoCamera camera = test_camera();
  std::vector<PoseObservation> observations = observe(camera, SE3{}, visible_points(camera, 60, 7));
  for (std::size_t i = 0; i < observations.size(); ++i) {
    observations[i].measurement.pixel = {double((i * 197) % 1241), double((i * 131) % 376),
                                         double((i * 57) % 1241)};
  }
  EXPECT_FALSE(solve_pnp_ransac(camera, observations, {}).has_value());
  EXPECT_FALSE(solve_pnp_ransac(camera, {}, {}).has_value());
  EXPECT_FALSE(solve_pnp_ransac(camera, std::span(observations).first(2), {}).has_value());
}

TEST(PoseOptimizer, ReturnsToThePoseDespiteOutliers) {
  const StereoCamera camera = test_camera();
  const SE3 truth = random_motion(8, 1.0, 0.1);
  std::vector<Eigen::Vector3d> points = visible_points(camera, 200, 9);
  for (Eigen::Vector3d& p : points) p = truth.inverse() * p;
  std::vector<PoseObservation> observations = observe(camera, truth, points);
  spoil(observations);
  const PoseEstimate estimate = optimize_pose(camera, random_motion(10, 0.2, 0.02) * truth, observations);
  EXPECT_LT(difference(estimate.T_cw, truth), 1e-4);
  EXPECT_EQ(estimate.inliers, 150);
  for (std::size_t i = 0; i < observations.size(); ++i) EXPECT_EQ(estimate.inlier[i] != 0, i % 4 != 0);
}

// More than half of the pairs are wrong, all to one side.
TEST(PoseOptimizer, GoesOnFromWhatRansacHasFound) {
  const StereoCamera camera = test_camera();
  const SE3 truth = random_motion(8, 1.0, 0.1);
  std::vector<Eigen::Vector3d> points = visible_points(camera, 200, 9);
  for (Eigen::Vector3d& p : points) p = truth.inverse() * p;
  std::vector<PoseObservation> observations = observe(camera, truth, points);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (i >= 90)
      observations[i].measurement.pixel += Eigen::Vector3d(80.0 + 3.0 * double(i % 50), 40.0, 80.0);
  }
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera, observations, {});
  ASSERT_TRUE(pnp);
  const PoseEstimate estimate = optimize_pose(camera, *pnp, observations);
  EXPECT_LT(difference(estimate.T_cw, truth), 1e-4);
  EXPECT_GE(estimate.inliers, 90);
}

TEST(PoseOptimizer, AnExpectationCountsWhereFewPointsAreSeen) {
  const StereoCamera camera = test_camera();
  const std::vector<PoseObservation> observations = observe(camera, SE3{}, visible_points(camera, 200, 12));
  PosePrior expected{{}, 0.1, 0.02};
  expected.T_cw.translation = {0.0, 0.0, -0.05};
  const PoseEstimate many = optimize_pose(camera, expected.T_cw, observations, expected);
  EXPECT_LT(many.T_cw.translation.norm(), 1e-3);

  // One pixel each of three far points says nothing about the way ahead: the expectation does.
  std::vector<PoseObservation> far;
  for (const double x : {-5.0, 0.0, 5.0}) {
    const Eigen::Vector3d point(x, 0.3 * x * x - 2.0, 400.0);
    far.push_back({point, {camera.project_stereo(point), 1.0, false}});
  }
  const PoseEstimate few = optimize_pose(camera, expected.T_cw, far, expected);
  EXPECT_EQ(few.inliers, 3);
  EXPECT_LT((few.T_cw.translation - expected.T_cw.translation).norm(), 0.02);
}

TEST(PoseOptimizer, TakesNumbersThatAreNoneAndTooFewPoints) {
  const StereoCamera camera = test_camera();
  std::vector<PoseObservation> observations = observe(camera, SE3{}, visible_points(camera, 50, 11));
  observations[3].point.x() = std::numeric_limits<double>::quiet_NaN();
  observations[5].measurement.pixel.y() = std::numeric_limits<double>::infinity();
  observations[7].point = {0.0, 0.0, -5.0};
  const PoseEstimate estimate = optimize_pose(camera, SE3{}, observations);
  EXPECT_EQ(estimate.inliers, 47);
  EXPECT_LT(estimate.T_cw.log().norm(), 1e-6);
  EXPECT_EQ(optimize_pose(camera, SE3{}, std::span(observations).first(2)).inliers, 0);
  EXPECT_EQ(optimize_pose(camera, SE3{}, {}).inliers, 0);
  SE3 broken;
  broken.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(optimize_pose(camera, broken, observations).inliers, 0);
}

}  // namespace
}  // namespace penumbra::slam
