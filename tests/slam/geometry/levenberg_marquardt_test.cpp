#include "slam/geometry/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>

namespace penumbra::slam {
namespace {

// Rosenbrock's valley: e = (10 (y - x^2), 1 - x), least at (1, 1).
struct Valley {
  Eigen::Vector2d at{-1.2, 1.0}, moved, step;
  Eigen::Matrix2d H;
  Eigen::Vector2d g;
  bool solvable = true;
  double spoilt = 0.0;  // added to every trial's cost

  static Eigen::Vector2d residual(const Eigen::Vector2d& x) {
    return {10.0 * (x.y() - x.x() * x.x()), 1.0 - x.x()};
  }
  static Eigen::Matrix2d jacobian(const Eigen::Vector2d& x) {
    return Eigen::Matrix2d{{-20.0 * x.x(), 10.0}, {-1.0, 0.0}};
  }
  double cost() const { return residual(at).squaredNorm(); }
  void linearize() {
    const Eigen::Matrix2d J = jacobian(at);
    H = J.transpose() * J;
    g = J.transpose() * residual(at);
  }
  bool solve(double lambda) {
    Eigen::Matrix2d damped = H;
    damped.diagonal() *= 1.0 + lambda;
    step = -damped.ldlt().solve(g);
    return solvable;
  }
  double trial_cost() {
    moved = at + step;
    return residual(moved).squaredNorm() + spoilt;
  }
  void accept() { at = moved; }
};

// The same for Eigen's translation of MINPACK.
struct MinpackValley {
  int inputs() const { return 2; }
  int values() const { return 2; }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& e) const {
    e = Valley::residual(x);
    return 0;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& J) const {
    J = Valley::jacobian(x);
    return 0;
  }
};

TEST(LevenbergMarquardt, EndsWhereMinpackEnds) {
  for (const Eigen::Vector2d& start : {Eigen::Vector2d(-1.2, 1.0), {3.0, -4.0}, {0.0, 0.0}, {-20.0, 30.0}}) {
    Valley valley;
    valley.at = start;
    const LeastSquaresSummary summary = levenberg_marquardt(valley, {.iterations = 200, .converged = 1e-12});
    MinpackValley function;
    Eigen::LevenbergMarquardt<MinpackValley> minpack(function);
    Eigen::VectorXd expected = start;
    minpack.minimize(expected);
    EXPECT_NEAR((valley.at - expected).norm(), 0.0, 1e-6) << start.transpose();
    EXPECT_EQ(summary.initial_cost, Valley::residual(start).squaredNorm());
    EXPECT_EQ(summary.final_cost, valley.cost());
    EXPECT_LT(summary.iterations, 200);
  }
}

TEST(LevenbergMarquardt, TakesNothingThatIsNoBetter) {
  for (const double spoilt : {1e6, std::numeric_limits<double>::quiet_NaN()}) {
    Valley valley;
    valley.spoilt = spoilt;
    const LeastSquaresSummary summary = levenberg_marquardt(valley, {.iterations = 50});
    EXPECT_EQ(valley.at, Valley().at);
    EXPECT_EQ(summary.final_cost, summary.initial_cost);
    EXPECT_EQ(summary.iterations, 13);  // 1e-5 has become 1e8
  }
}

TEST(LevenbergMarquardt, GivesUpEquationsWithoutSolution) {
  Valley valley;
  valley.solvable = false;
  const LeastSquaresSummary summary = levenberg_marquardt(valley, {.iterations = 50, .initial_lambda = 0.0});
  EXPECT_EQ(summary.iterations, 50);  // nothing raises a lambda of 0 ...
  const LeastSquaresSummary raised =
      levenberg_marquardt(valley, {.iterations = 50, .initial_lambda = 0.0, .smallest_raised = 1e-6});
  EXPECT_LE(raised.iterations, 9);  // ... but this bound
  EXPECT_EQ(valley.at, Valley().at);
}

TEST(LevenbergMarquardt, StopsWhenTold) {
  Valley valley;
  const std::atomic<bool> stop = true;
  EXPECT_EQ(levenberg_marquardt(valley, {.stop = &stop}).iterations, 0);
  EXPECT_EQ(levenberg_marquardt(valley, {.iterations = 0}).iterations, 0);
}

}  // namespace
}  // namespace penumbra::slam
