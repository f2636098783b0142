// Levenberg-Marquardt's loop: least squares by damped normal equations.
//
//   (J^T J + lambda diag(J^T J)) x = -J^T e
//
// The step x is taken where it lowers the cost, and the next one is damped less; otherwise it is tried again,
// damped more. The loop knows nothing of the unknowns: a Problem holds them, their trial values, and its
// equations,
//
//   double cost()             at the unknowns; called once, first
//   void linearize()          makes the normal equations at the unknowns
//   bool solve(lambda)        a step from them; false where the equations have no finite solution
//   double trial_cost()       at the unknowns moved by that step
//   void accept()             makes the moved unknowns the unknowns
//
// so that nothing is copied or allocated here. Source: Nocedal and Wright, Numerical Optimization (2006),
// section 10.3.
#pragma once

#include <algorithm>
#include <atomic>

namespace penumbra::slam {

struct LeastSquaresSettings {
  int iterations = 10;  // at most, failed ones included
  double initial_lambda = 1e-5;
  double smallest_lambda = 0.0;             // that a step that succeeds leads to
  double smallest_raised = 0.0;             // that a step that fails leads to
  double largest_lambda = 1e8;              // from here on there is no hope
  double raise = 10.0;                      // lambda grows so much where the cost rises
  double converged = 1e-4;                  // relative decrease of the cost that ends the iterations
  const std::atomic<bool>* stop = nullptr;  // set by somebody else: no further iteration begins
};

struct LeastSquaresSummary {
  double initial_cost = 0.0, final_cost = 0.0;
  int iterations = 0;
};

// Improves the unknowns of `problem`; the cost never rises.
template <typename Problem>
LeastSquaresSummary levenberg_marquardt(Problem& problem, const LeastSquaresSettings& settings) {
  constexpr double kLower = 0.1, kRaiseUnsolved = 100.0;
  LeastSquaresSummary summary;
  summary.initial_cost = summary.final_cost = problem.cost();
  double lambda = settings.initial_lambda;
  bool linearized = false;
  while (summary.iterations < settings.iterations && lambda < settings.largest_lambda) {
    if (settings.stop != nullptr && settings.stop->load(std::memory_order_relaxed)) break;
    ++summary.iterations;
    if (!linearized) problem.linearize();
    linearized = true;
    if (!problem.solve(lambda)) {
      lambda = std::max(lambda * kRaiseUnsolved, settings.smallest_raised);
      continue;
    }
    const double cost = problem.trial_cost();
    if (!(cost <= summary.final_cost)) {  // also where it is not a number
      lambda = std::max(lambda * settings.raise, settings.smallest_raised);
      continue;
    }
    const bool converged = summary.final_cost - cost <= settings.converged * summary.final_cost;
    problem.accept();
    summary.final_cost = cost;
    lambda = std::max(lambda * kLower, settings.smallest_lambda);
    linearized = false;
    if (converged) break;
  }
  return summary;
}

}  // namespace penumbra::slam
