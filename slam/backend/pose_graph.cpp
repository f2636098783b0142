#include "slam/backend/pose_graph.h"

#include <algorithm>
#include <utility>

#include "nn/base/error.h"
#include "slam/backend/block_cholesky.h"

namespace penumbra::slam {

namespace {

constexpr double kSmallestDiagonal = 1e-12;  // holds poses that no edge holds

void check(const PoseGraph& graph) {
  const int n = static_cast<int>(graph.poses.size());
  if (graph.fixed.size() != graph.poses.size()) {
    throw UsageError(fmt::format("pose graph: {} poses but {} flags", n, graph.fixed.size()));
  }
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.i == edge.j || edge.i < 0 || edge.j < 0 || edge.i >= n || edge.j >= n) {
      throw UsageError(fmt::format("pose graph: an edge from {} to {} among {} poses", edge.i, edge.j, n));
    }
  }
}

// The poses, their trial values and the equations, as levenberg_marquardt.h wants them.
class Solver {
 public:
  explicit Solver(PoseGraph& graph) : graph_(graph), steps_(graph.poses.size(), Vector6d::Zero()) {
    for (const char fixed : graph.fixed) slot_.push_back(fixed ? -1 : free_++);
    std::vector<std::vector<int>> columns(static_cast<std::size_t>(free_));
    for (int a = 0; a < free_; ++a) columns[std::size_t(a)].push_back(a);
    for (const PoseGraphEdge& edge : graph.edges) {
      const auto [a, b] = ends(edge);
      if (a >= 0) columns[std::size_t(a)].push_back(b);
    }
    first_block_.assign(1, 0);
    for (std::vector<int>& row : columns) {
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      first_block_.push_back(first_block_.back() + row.size());
    }
    blocks_.resize(first_block_.back());
    for (const PoseGraphEdge& edge : graph.edges) {
      const auto [a, b] = ends(edge);
      if (a < 0) {
        place_.push_back(blocks_.size());
        continue;
      }
      const std::vector<int>& row = columns[std::size_t(a)];
      place_.push_back(first_block_[std::size_t(a)] +
                       static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), b) - row.begin()));
    }
    if (free_ > 0) cholesky_ = BlockCholesky(columns);
  }

  double cost() const { return cost(graph_.poses); }
  double trial_cost() {
    moved_ = graph_.poses;
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      if (graph_.fixed[i]) continue;
      moved_[i] = SE3::exp(steps_[i]) * moved_[i];
      moved_[i].normalize();
    }
    return cost(moved_);
  }
  void accept() { graph_.poses.swap(moved_); }

  double cost(const std::vector<SE3>& poses) const {
    double sum = 0.0;
    for (const PoseGraphEdge& edge : graph_.edges) {
      const SE3 error =
          poses[std::size_t(edge.i)] * poses[std::size_t(edge.j)].inverse() * edge.T_ij.inverse();
      const Vector6d e = error.log();
      sum += e.dot(edge.information * e);
    }
    return sum;
  }

  void linearize() {
    for (Matrix6d& block : blocks_) block.setZero();
    gradient_ = Eigen::VectorXd::Zero(6 * free_);
    for (std::size_t n = 0; n < graph_.edges.size(); ++n) {
      const PoseGraphEdge& edge = graph_.edges[n];
      const PoseGraphResidual r = pose_graph_residual(graph_.poses[std::size_t(edge.i)],
                                                      graph_.poses[std::size_t(edge.j)], edge.T_ij);
      const int a = slot_[std::size_t(edge.i)], b = slot_[std::size_t(edge.j)];
      const Matrix6d weighted_i = r.J_i.transpose() * edge.information;
      const Matrix6d weighted_j = r.J_j.transpose() * edge.information;
      if (a >= 0) {
        diagonal(a).noalias() += weighted_i * r.J_i;
        gradient_.segment<6>(6 * a).noalias() += weighted_i * r.e;
      }
      if (b >= 0) {
        diagonal(b).noalias() += weighted_j * r.J_j;
        gradient_.segment<6>(6 * b).noalias() += weighted_j * r.e;
      }
      // The upper triangle alone.
      if (a < 0 || b < 0) continue;
      if (a < b)
        blocks_[place_[n]].noalias() += weighted_i * r.J_j;
      else
        blocks_[place_[n]].noalias() += weighted_j * r.J_i;
    }
  }

  // Steps of all free poses; false where the equations are singular.
  bool solve(double lambda) {
    damped_ = blocks_;
    for (int a = 0; a < free_; ++a) {
      Matrix6d& block = damped_[first_block_[std::size_t(a)]];
      block.diagonal() *= 1.0 + lambda;
      block.diagonal().array() += kSmallestDiagonal;
    }
    if (!cholesky_.factorise(damped_)) return false;
    const Eigen::VectorXd x = cholesky_.solve(-gradient_);
    if (!x.allFinite()) return false;
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] >= 0) steps_[i] = x.segment<6>(6 * slot_[i]);
    }
    return true;
  }

  int free_poses() const { return free_; }

 private:
  // Slots of the free poses that an edge joins, the smaller first; -1 and -1 where one of them is fixed.
  std::pair<int, int> ends(const PoseGraphEdge& edge) const {
    const int a = slot_[std::size_t(edge.i)], b = slot_[std::size_t(edge.j)];
    if (a < 0 || b < 0) return {-1, -1};
    return {std::min(a, b), std::max(a, b)};
  }
  Matrix6d& diagonal(int a) { return blocks_[first_block_[std::size_t(a)]]; }

  PoseGraph& graph_;
  std::vector<Vector6d> steps_;  // a pose; zero where it is fixed
  std::vector<SE3> moved_;
  int free_ = 0;
  std::vector<int> slot_;  // pose -> place among the free ones; -1 where it is fixed
  // Of the equations, the upper triangle row by row, each row's diagonal first.
  std::vector<Matrix6d> blocks_, damped_;
  std::vector<std::size_t> first_block_;  // per row
  std::vector<std::size_t> place_;        // per edge, its block
  Eigen::VectorXd gradient_;
  BlockCholesky cholesky_;
};

}  // namespace

PoseGraphResidual pose_graph_residual(const SE3& T_i, const SE3& T_j, const SE3& T_ij) {
  PoseGraphResidual r;
  r.e = (T_i * T_j.inverse() * T_ij.inverse()).log();
  r.J_i = left_jacobian_inverse(r.e);
  r.J_j = -left_jacobian_inverse(-r.e) * adjoint(T_ij);
  return r;
}

LeastSquaresSummary solve_pose_graph(PoseGraph& graph, const PoseGraphSettings& settings) {
  check(graph);
  Solver solver(graph);
  if (solver.free_poses() == 0 || graph.edges.empty()) return {solver.cost(), solver.cost(), 0};
  return levenberg_marquardt(solver, {.iterations = settings.iterations,
                                      .initial_lambda = settings.initial_lambda,
                                      .smallest_raised = 1e-6,
                                      .converged = settings.converged});
}

}  // namespace penumbra::slam
