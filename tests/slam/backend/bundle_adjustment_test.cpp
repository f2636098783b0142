#include "slam/backend/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

// `poses` cameras a metre apart that look at common points; pose 0 (and 1 if asked) is fixed.
BundleProblem make_problem(int poses, int points, double pixel_noise) {
  BundleProblem problem;
  problem.camera = test::test_camera();
  for (int i = 0; i < poses; ++i) {
    SE3 T_cw = test::random_motion(50 + i, 0.1, 0.03);
    T_cw.translation.z() -= 0.5 * i;
    problem.poses.push_back(T_cw);
    problem.pose_fixed.push_back(i == 0);
  }
  problem.points = test::visible_points(problem.camera, points, 60);
  for (Eigen::Vector3d& p : problem.points) p.z() += 2.0 + 0.5 * poses;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, pixel_noise);
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < poses; ++i) {
      if ((i + j) % 4 == 0 && poses > 2) continue;  // not everything is seen by all
      PixelMeasurement z;
      z.pixel = problem.camera.project_stereo(problem.poses[std::size_t(i)] * problem.points[std::size_t(j)]);
      for (int k = 0; k < 3; ++k) z.pixel[k] += pixel_noise > 0.0 ? noise(random) : 0.0;
      z.stereo = (i + j) % 3 != 0;
      z.inverse_variance = 1.0 / (1.0 + 0.2 * (j % 5));
      problem.observations.push_back({i, j, z, true});
    }
  }
  return problem;
}

void disturb(BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (!problem.pose_fixed[i])
      problem.poses[i] = test::random_motion(int(i) + 7, 0.05, 0.01) * problem.poses[i];
  }
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (Eigen::Vector3d& p : problem.points) p += Eigen::Vector3d(noise(random), noise(random), noise(random));
}

// All weighted errors of the problem in one vector, the prior's of the disparity offset last, after moving
// the free poses, the points and, where it is adjusted, the offset by `x`.
Eigen::VectorXd errors(const BundleProblem& problem, const Eigen::VectorXd& x) {
  std::vector<SE3> poses = problem.poses;
  int at = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (problem.pose_fixed[i]) continue;
    poses[i] = SE3::exp(x.segment<6>(at)) * poses[i];
    at += 6;
  }
  StereoCamera camera = problem.camera;
  const bool adjusts_offset = problem.disparity_offset_sigma > 0.0;
  if (adjusts_offset) camera.disparity_offset += x[x.size() - 1];
  Eigen::VectorXd e(3 * static_cast<int>(problem.observations.size()) + adjusts_offset);
  if (adjusts_offset) e[e.size() - 1] = camera.disparity_offset / problem.disparity_offset_sigma;
  for (std::size_t k = 0; k < problem.observations.size(); ++k) {
    const BundleObservation& o = problem.observations[k];
    const Eigen::Vector3d X = problem.points[std::size_t(o.point)] + x.segment<3>(at + 3 * o.point);
    e.segment<3>(3 * int(k)) = reprojection_error(camera, poses[std::size_t(o.pose)] * X, o.measurement) *
                               std::sqrt(o.measurement.inverse_variance);
  }
  return e;
}

void expect_step_of_dense_solution(const BundleProblem& problem) {
  const bool adjusts_offset = problem.disparity_offset_sigma > 0.0;
  const int n = 6 * 3 + 3 * 12 + adjusts_offset;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n), e = errors(problem, zero);
  Eigen::MatrixXd J(e.size(), n);
  const double h = 1e-6;
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, k);
    J.col(k) = (errors(problem, step) - errors(problem, -step)) / (2.0 * h);
  }
  const double lambda = 1e-3;
  Eigen::MatrixXd H = J.transpose() * J;
  H.diagonal() *= 1.0 + lambda;
  const Eigen::VectorXd dense = -H.ldlt().solve(J.transpose() * e);

  const BundleStep step = bundle_step(problem, false, lambda);
  ASSERT_EQ(step.poses.size(), 4U);
  EXPECT_EQ(step.poses[0].norm(), 0.0);
  for (int i = 1; i < 4; ++i) {
    EXPECT_LT((step.poses[std::size_t(i)] - dense.segment<6>(6 * (i - 1))).norm(), 1e-5 * dense.norm());
  }
  for (int j = 0; j < 12; ++j) {
    EXPECT_LT((step.points[std::size_t(j)] - dense.segment<3>(18 + 3 * j)).norm(), 1e-5 * dense.norm());
  }
  if (adjusts_offset) {
    EXPECT_NEAR(step.disparity_offset, dense[n - 1], 1e-5 * dense.norm());
  } else {
    EXPECT_EQ(step.disparity_offset, 0.0);
  }
}

TEST(BundleAdjustment, StepEqualsTheDenseSolutionWithNumericDerivatives) {
  BundleProblem problem = make_problem(4, 12, 0.5);
  disturb(problem);
  expect_step_of_dense_solution(problem);
  problem.camera.disparity_offset = 0.3;
  expect_step_of_dense_solution(problem);
  problem.disparity_offset_sigma = 0.2;
  expect_step_of_dense_solution(problem);
}

TEST(BundleAdjustment, FindsTheDisparityOffset) {
  for (const double offset : {-0.4, 0.0, 0.2}) {
    BundleProblem problem = make_problem(6, 200, 0.3);
    for (BundleObservation& o : problem.observations) o.measurement.pixel.z() -= offset;
    BundleProblem unaware = problem;
    disturb(problem);
    problem.disparity_offset_sigma = 1.0;  // a prior that hardly counts
    BundleSettings settings;
    settings.iterations = 40;
    settings.converged = 0.0;
    solve_bundle(problem, settings);
    EXPECT_NEAR(problem.camera.disparity_offset, offset, 0.05);
    solve_bundle(unaware, settings);
    EXPECT_EQ(unaware.camera.disparity_offset, 0.0);
  }
}

TEST(BundleAdjustment, KeepsToThePriorWhereNothingShowsTheDisparityOffset) {
  BundleProblem problem = make_problem(3, 30, 0.3);
  problem.disparity_offset_sigma = 0.1;
  for (BundleObservation& o : problem.observations) o.measurement.stereo = false;
  solve_bundle(problem, {});
  EXPECT_EQ(problem.camera.disparity_offset, 0.0);
}

TEST(BundleAdjustment, ConvergesToTheTruthOnExactData) {
  const BundleProblem truth = make_problem(6, 80, 0.0);
  BundleProblem problem = truth;
  disturb(problem);
  BundleSettings settings;
  settings.iterations = 30;
  settings.converged = 0.0;
  const LeastSquaresSummary summary = solve_bundle(problem, settings);
  EXPECT_LT(summary.final_cost, 1e-10 * summary.initial_cost);
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    EXPECT_LT((problem.poses[i] * truth.poses[i].inverse()).log().norm(), 1e-6);
  }
  for (std::size_t j = 0; j < truth.points.size(); ++j)
    EXPECT_LT((problem.points[j] - truth.points[j]).norm(), 1e-3);
}

TEST(BundleAdjustment, ShrugsOffOutliersWithTheRobustKernel) {
  const BundleProblem truth = make_problem(6, 150, 0.3);
  const auto error_after = [&](bool robust) {
    BundleProblem problem = truth;
    for (std::size_t k = 0; k < problem.observations.size(); k += 17) {
      problem.observations[k].measurement.pixel += Eigen::Vector3d(40.0, 25.0, 35.0);
    }
    disturb(problem);
    BundleSettings settings;
    settings.iterations = 40;
    settings.robust = robust;
    solve_bundle(problem, settings);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.poses.size(); ++i) {
      sum += (problem.poses[i] * truth.poses[i].inverse()).log().norm();
    }
    return sum;
  };
  EXPECT_LT(error_after(true), 0.3 * error_after(false));
}

TEST(BundleAdjustment, NeverRaisesTheCostAndKeepsFixedPoses) {
  BundleProblem problem = make_problem(5, 40, 1.0);
  problem.pose_fixed[1] = 1;
  disturb(problem);
  const BundleProblem before = problem;
  const LeastSquaresSummary summary = solve_bundle(problem, {});
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_EQ(problem.poses[i].translation, before.poses[i].translation);
    EXPECT_EQ(problem.poses[i].rotation, before.poses[i].rotation);
  }
}

TEST(BundleAdjustment, IsTheSameForAnyNumberOfThreads) {
  BundleProblem problem = make_problem(8, 3400, 0.5);
  problem.disparity_offset_sigma = 0.3;
  disturb(problem);
  ASSERT_GE(problem.observations.size(), kBundleWorthThreads);
  BundleSettings settings;
  settings.iterations = 2;
  BundleProblem alone = problem;
  const LeastSquaresSummary summary = solve_bundle(alone, settings);
  for (const int threads : {2, 3, 16}) {
    settings.threads = threads;
    BundleProblem shared = problem;
    EXPECT_EQ(solve_bundle(shared, settings).final_cost, summary.final_cost);
    EXPECT_EQ(shared.camera.disparity_offset, alone.camera.disparity_offset);
    for (std::size_t i = 0; i < alone.poses.size(); ++i) {
      ASSERT_EQ(shared.poses[i].translation, alone.poses[i].translation) << threads;
      ASSERT_EQ(shared.poses[i].rotation, alone.poses[i].rotation) << threads;
    }
    for (std::size_t j = 0; j < alone.points.size(); ++j) ASSERT_EQ(shared.points[j], alone.points[j]);
  }
}

TEST(BundleAdjustment, TakesUnseenPointsPointsBehindAndNothingAtAll) {
  BundleProblem problem = make_problem(3, 10, 0.2);
  problem.points.push_back({1.0, 2.0, 3.0});  // nobody sees it
  problem.points[2] = {0.0, 0.0, -50.0};      // behind every camera
  for (BundleObservation& o : problem.observations) o.active = o.point != 4;
  solve_bundle(problem, {});
  EXPECT_EQ(problem.points.back(), Eigen::Vector3d(1.0, 2.0, 3.0));
  for (const SE3& pose : problem.poses) EXPECT_TRUE(pose.is_finite());
  for (const Eigen::Vector3d& p : problem.points) EXPECT_TRUE(p.allFinite());
  BundleProblem nothing;
  nothing.camera = test::test_camera();
  EXPECT_EQ(solve_bundle(nothing, {}).final_cost, 0.0);
}

}  // namespace
}  // namespace penumbra::slam
