#include "slam/backend/pose_graph.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "nn/base/error.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

SE3 moved(const SE3& T, int component, double by) {
  Vector6d xi = Vector6d::Zero();
  xi[component] = by;
  return SE3::exp(xi) * T;
}

TEST(PoseGraph, DerivativesAgreeWithNumericOnes) {
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 T_i = test::random_motion(3 * trial, 5.0, 1.0),
              T_j = test::random_motion(3 * trial + 1, 5.0, 1.0);
    // From errors of nothing to large ones.
    const SE3 T_ij = test::random_motion(3 * trial + 2, 0.1 * trial, 0.1 * trial) * (T_i * T_j.inverse());
    const PoseGraphResidual r = pose_graph_residual(T_i, T_j, T_ij);
    constexpr double h = 1e-6;
    for (int c = 0; c < 6; ++c) {
      const Vector6d by_i = (pose_graph_residual(moved(T_i, c, h), T_j, T_ij).e -
                             pose_graph_residual(moved(T_i, c, -h), T_j, T_ij).e) /
                            (2.0 * h);
      const Vector6d by_j = (pose_graph_residual(T_i, moved(T_j, c, h), T_ij).e -
                             pose_graph_residual(T_i, moved(T_j, c, -h), T_ij).e) /
                            (2.0 * h);
      EXPECT_LT((r.J_i.col(c) - by_i).norm(), 1e-6 * (1.0 + by_i.norm())) << trial << " " << c;
      EXPECT_LT((r.J_j.col(c) - by_j).norm(), 1e-6 * (1.0 + by_j.norm())) << trial << " " << c;
    }
  }
}

// Camera `k` of `n` on a circle, looking along it.
SE3 on_circle(int k, int n, double radius) {
  const double angle = 2.0 * std::numbers::pi * k / n;
  SE3 T_wc;
  T_wc.rotation = so3_exp(Eigen::Vector3d(0.0, -angle, 0.0));
  T_wc.translation = {radius * (std::cos(angle) - 1.0), 0.0, radius * std::sin(angle)};
  return T_wc.inverse();
}

// docs/slam/loops.md, "An example by hand".
TEST(PoseGraph, TheExampleOfTheChapter) {
  const auto at = [](double z) {
    SE3 T_wc;
    T_wc.translation.z() = z;
    return T_wc.inverse();
  };
  for (const auto& [weight, expected] : {std::pair(1.0, std::array{1.025, 2.05, 3.075}),
                                         std::pair(10.0, std::array{1.0032, 2.0065, 3.0097})}) {
    PoseGraph graph;
    for (int k = 0; k < 4; ++k) graph.poses.push_back(at(1.1 * k));
    graph.fixed = {1, 0, 0, 0};
    for (int k = 0; k < 3; ++k) graph.edges.push_back({k + 1, k, at(1.1), Matrix6d::Identity()});
    graph.edges.push_back({3, 0, at(3.0), weight * Matrix6d::Identity()});
    solve_pose_graph(graph);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(graph.poses[k + 1].inverse().translation.z(), expected[k], 1e-4) << weight;
    }
  }
}

TEST(PoseGraph, ALoopTakesTheDriftOutOfAChain) {
  constexpr int kPoses = 200;
  std::vector<SE3> truth;
  for (int k = 0; k < kPoses; ++k) truth.push_back(on_circle(k, kPoses, 50.0));
  PoseGraph graph;
  graph.poses.push_back(truth[0]);
  graph.fixed.assign(kPoses, 0);
  graph.fixed[0] = 1;
  // Every step turns a little too far and is a little too long.
  const SE3 drift = SE3::exp((Vector6d() << 0.002, 0.0, 0.01, 0.0, 0.0005, 0.0).finished());
  for (int k = 1; k < kPoses; ++k) {
    const SE3 step = drift * truth[std::size_t(k)] * truth[std::size_t(k) - 1].inverse();
    graph.poses.push_back(step * graph.poses.back());
    graph.edges.push_back({k, k - 1, step, Matrix6d::Identity()});
  }
  const auto error = [&](int k) {
    return (graph.poses[std::size_t(k)].inverse().translation - truth[std::size_t(k)].inverse().translation)
        .norm();
  };
  const double error_before = error(kPoses - 1), half_before = error(kPoses / 2);
  EXPECT_GT(error_before, 2.0);
  graph.edges.push_back({kPoses - 1, 0, truth.back() * truth[0].inverse(), 1e4 * Matrix6d::Identity()});
  const LeastSquaresSummary summary = solve_pose_graph(graph);
  EXPECT_LT(summary.final_cost, 1e-2 * summary.initial_cost);
  EXPECT_LE(summary.iterations, 20);
  EXPECT_LT(error(kPoses - 1), 0.01);
  EXPECT_LT(error(kPoses / 2), half_before);
}

TEST(PoseGraph, PerturbedPosesGoBackToWhereTheMeasurementsAgree) {
  std::vector<SE3> truth;
  PoseGraph graph;
  for (int k = 0; k < 30; ++k) {
    truth.push_back(on_circle(k, 30, 10.0));
    graph.poses.push_back(k == 0 ? truth[0] : test::random_motion(k, 0.5, 0.2) * truth.back());
  }
  graph.fixed.assign(30, 0);
  graph.fixed[0] = 1;
  for (int k = 0; k < 30; ++k) {
    for (const int step : {1, 2, 7}) {
      const int j = (k + step) % 30;
      graph.edges.push_back(
          {k, j, truth[std::size_t(k)] * truth[std::size_t(j)].inverse(), Matrix6d::Identity()});
    }
  }
  const LeastSquaresSummary summary = solve_pose_graph(graph);
  EXPECT_LT(summary.final_cost, 1e-12);
  for (int k = 0; k < 30; ++k) {
    EXPECT_LT((graph.poses[std::size_t(k)] * truth[std::size_t(k)].inverse()).log().norm(), 1e-6) << k;
  }
}

// The example of docs/slam/loops.md: round a block of 10 x 10 m; the second side was measured 0.4 m too long.
TEST(PoseGraph, TheWorkedExampleOfTheChapterHolds) {
  const auto camera_at = [](double x, double z) {
    SE3 T_cw;
    T_cw.translation = {-x, 0.0, -z};
    return T_cw;
  };
  // T_ij where camera i is (x, z) further than j; the turns are certain.
  const auto edge = [](int i, int j, double x, double z, double information) {
    PoseGraphEdge e{i, j, SE3{}, Matrix6d::Identity()};
    e.T_ij.translation = {-x, 0.0, -z};
    e.information.diagonal() << information, information, information, 1e9, 1e9, 1e9;
    return e;
  };
  const auto expect_at = [](const SE3& T_cw, double x, double z) {
    const Eigen::Vector3d c = T_cw.inverse().translation;
    EXPECT_NEAR(c.x(), x, 1e-3);
    EXPECT_NEAR(c.z(), z, 1e-3);
  };
  PoseGraph graph;
  graph.poses = {camera_at(0, 0), camera_at(0, 10), camera_at(10.4, 10), camera_at(10.4, 0)};
  graph.fixed = {1, 0, 0, 0};
  graph.edges = {edge(1, 0, 0, 10, 1), edge(2, 1, 10.4, 0, 1), edge(3, 2, 0, -10, 1)};
  EXPECT_NEAR(solve_pose_graph(graph).initial_cost, 0.0, 1e-12);

  PoseGraph loop = graph;
  loop.edges.push_back(edge(0, 3, -10, 0, 1));
  const LeastSquaresSummary equal = solve_pose_graph(loop);
  EXPECT_NEAR(equal.initial_cost, 0.16, 1e-9);
  EXPECT_NEAR(equal.final_cost, 0.04, 1e-4);
  expect_at(loop.poses[1], -0.1, 10.0);
  expect_at(loop.poses[2], 10.2, 10.0);
  expect_at(loop.poses[3], 10.1, 0.0);

  loop = graph;
  loop.edges.push_back(edge(0, 3, -10, 0, 100));
  EXPECT_NEAR(solve_pose_graph(loop).final_cost, 0.16 / 3.01, 1e-4);
  expect_at(loop.poses[3], 10.0 + 0.4 / 301.0, 0.0);
}

TEST(PoseGraph, DegenerateGraphsAreLeftAlone) {
  PoseGraph graph;
  EXPECT_EQ(solve_pose_graph(graph).iterations, 0);
  graph.poses = {SE3{}, test::random_motion(1, 1.0, 0.1), test::random_motion(2, 1.0, 0.1)};
  graph.fixed = {1, 0, 0};
  EXPECT_EQ(solve_pose_graph(graph).iterations, 0);
  // The third pose has no edge and stays; the second goes where its edge says.
  const SE3 lonely = graph.poses[2], measured = test::random_motion(3, 1.0, 0.1);
  graph.edges.push_back({1, 0, measured, Matrix6d::Identity()});
  solve_pose_graph(graph);
  EXPECT_EQ(graph.poses[2].translation, lonely.translation);
  EXPECT_LT((graph.poses[1] * measured.inverse()).log().norm(), 1e-9);
  graph.edges.push_back({1, 1, measured, Matrix6d::Identity()});
  EXPECT_THROW(solve_pose_graph(graph), UsageError);
  graph.edges.back() = {1, 3, measured, Matrix6d::Identity()};
  EXPECT_THROW(solve_pose_graph(graph), UsageError);
  graph.edges.pop_back();
  graph.fixed.pop_back();
  EXPECT_THROW(solve_pose_graph(graph), UsageError);
}

}  // namespace
}  // namespace penumbra::slam
