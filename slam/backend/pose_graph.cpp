#include "slam/backend/pose_graph.h"

#include <Eigen/SparseCholesky>

#include "nn/base/error.h"

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
    blocks_.clear();
    gradient_ = Eigen::VectorXd::Zero(6 * free_);
    diagonal_.assign(std::size_t(free_), Matrix6d::Zero());
    for (const PoseGraphEdge& edge : graph_.edges) {
      const PoseGraphResidual r = pose_graph_residual(graph_.poses[std::size_t(edge.i)],
                                                      graph_.poses[std::size_t(edge.j)], edge.T_ij);
      const int a = slot_[std::size_t(edge.i)], b = slot_[std::size_t(edge.j)];
      const Matrix6d weighted_i = r.J_i.transpose() * edge.information;
      const Matrix6d weighted_j = r.J_j.transpose() * edge.information;
      if (a >= 0) {
        diagonal_[std::size_t(a)].noalias() += weighted_i * r.J_i;
        gradient_.segment<6>(6 * a).noalias() += weighted_i * r.e;
      }
      if (b >= 0) {
        diagonal_[std::size_t(b)].noalias() += weighted_j * r.J_j;
        gradient_.segment<6>(6 * b).noalias() += weighted_j * r.e;
      }
      // The lower triangle alone.
      if (a >= 0 && b >= 0) {
        if (a > b) {
          add_block(a, b, weighted_i * r.J_j);
        } else {
          add_block(b, a, weighted_j * r.J_i);
        }
      }
    }
  }

  // Steps of all free poses; false where the equations are singular.
  bool solve(double lambda) {
    std::vector<Eigen::Triplet<double>> entries = blocks_;
    for (int a = 0; a < free_; ++a) {
      Matrix6d block = diagonal_[std::size_t(a)];
      block.diagonal() *= 1.0 + lambda;
      block.diagonal().array() += kSmallestDiagonal;
      for (int row = 0; row < 6; ++row) {
        for (int column = 0; column <= row; ++column) {
          entries.emplace_back(6 * a + row, 6 * a + column, block(row, column));
        }
      }
    }
    Eigen::SparseMatrix<double> H(6 * free_, 6 * free_);
    H.setFromTriplets(entries.begin(), entries.end());
    if (!analysed_) cholesky_.analyzePattern(H);
    analysed_ = true;
    cholesky_.factorize(H);
    if (cholesky_.info() != Eigen::Success) return false;
    const Eigen::VectorXd x = cholesky_.solve(-gradient_);
    if (!x.allFinite()) return false;
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] >= 0) steps_[i] = x.segment<6>(6 * slot_[i]);
    }
    return true;
  }

  int free_poses() const { return free_; }

 private:
  void add_block(int row, int column, const Matrix6d& block) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) blocks_.emplace_back(6 * row + r, 6 * column + c, block(r, c));
    }
  }

  PoseGraph& graph_;
  std::vector<Vector6d> steps_;  // a pose; zero where it is fixed
  std::vector<SE3> moved_;
  int free_ = 0;
  std::vector<int> slot_;  // pose -> place among the free ones; -1 where it is fixed
  std::vector<Eigen::Triplet<double>> blocks_;
  std::vector<Matrix6d> diagonal_;
  Eigen::VectorXd gradient_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky_;
  bool analysed_ = false;
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
