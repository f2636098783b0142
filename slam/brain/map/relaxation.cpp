#include "slam/brain/map/relaxation.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

namespace {

using Poses = std::vector<PlanePose>;
using Triplets = std::vector<Eigen::Triplet<double>>;

Poses poses_of(const CognitiveMap& map) {
  Poses poses;
  for (const Node& node : map.nodes()) poses.push_back(node.pose);
  return poses;
}

bool all_finite(const Poses& poses) {
  return std::all_of(poses.begin(), poses.end(), [](const PlanePose& pose) { return pose.is_finite(); });
}

// By how much the link's far end is from where the near end expects it, in the world's axes.
PlanePose disagreement_of(const Link& link, const PlanePose& from, const PlanePose& to) {
  const PlanePose expected = from * link.motion;
  return {to.x - expected.x, to.y - expected.y, wrapped_angle(to.heading - expected.heading)};
}

// One sweep, a node after the other; returns the largest move.
double sweep(const CognitiveMap& map, const RelaxationSettings& settings, Poses& poses) {
  const bool is_paper = settings.mode == RelaxationMode::paper;
  double largest = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const std::vector<int>& links = map.links_of(static_cast<int>(i));
    PlanePose pull;
    for (const int number : links) {
      const Link& link = map.links()[static_cast<std::size_t>(number)];
      const PlanePose e = disagreement_of(link, poses[static_cast<std::size_t>(link.from)],
                                          poses[static_cast<std::size_t>(link.to)]);
      const double sign = static_cast<std::size_t>(link.from) == i ? 1.0 : -1.0;
      pull = {pull.x + sign * e.x, pull.y + sign * e.y, pull.heading + sign * e.heading};
    }
    if (links.empty()) continue;
    const double rho = is_paper ? settings.rho : settings.rho / static_cast<double>(links.size());
    poses[i].x += rho * pull.x;
    poses[i].y += rho * pull.y;
    if (!is_paper) poses[i].heading = wrapped_angle(poses[i].heading + rho * pull.heading);
    largest = std::max(largest, rho * std::hypot(pull.x, pull.y));
  }
  return largest;
}

// The normal equations of all nodes but the first, and their solution.
class Equations {
 public:
  Equations(int nodes, int per_node)
      : per_node_(per_node), gradient_(Eigen::VectorXd::Zero((nodes - 1) * per_node)) {}

  // A residual e of variance 1 / weight with derivatives after the unknowns of nodes i and j.
  template <typename Row>
  void add(int i, int j, const Row& d_i, const Row& d_j, double e, double weight) {
    add_block(i, i, d_i, d_i, weight);
    add_block(j, j, d_j, d_j, weight);
    add_block(i, j, d_i, d_j, weight);
    add_block(j, i, d_j, d_i, weight);
    for (int k = 0; k < per_node_; ++k) {
      if (i > 0) gradient_[(i - 1) * per_node_ + k] += weight * d_i[k] * e;
      if (j > 0) gradient_[(j - 1) * per_node_ + k] += weight * d_j[k] * e;
    }
  }

  // The step; empty where the equations have no solution.
  Eigen::VectorXd solve() {
    const Eigen::Index size = gradient_.size();
    // What no link holds stays where it is.
    for (int k = 0; k < size; ++k) triplets_.emplace_back(k, k, 1e-9);
    Eigen::SparseMatrix<double> hessian(size, size);
    hessian.setFromTriplets(triplets_.begin(), triplets_.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(hessian);
    if (solver.info() != Eigen::Success) return {};
    return solver.solve(-gradient_);
  }

 private:
  template <typename Row>
  void add_block(int i, int j, const Row& a, const Row& b, double weight) {
    if (i == 0 || j == 0) return;
    for (int r = 0; r < per_node_; ++r) {
      for (int c = 0; c < per_node_; ++c)
        triplets_.emplace_back((i - 1) * per_node_ + r, (j - 1) * per_node_ + c, weight * a[r] * b[c]);
    }
  }

  int per_node_;
  Triplets triplets_;
  Eigen::VectorXd gradient_;
};

// The headings that the links' turns alone agree on best: linear but for whole turns, which the present
// headings decide.
void settle_headings(const CognitiveMap& map, Poses& poses) {
  Equations equations(map.size(), 1);
  for (const Link& link : map.links()) {
    const double e = disagreement_of(link, poses[static_cast<std::size_t>(link.from)],
                                     poses[static_cast<std::size_t>(link.to)])
                         .heading;
    equations.add(link.from, link.to, Eigen::Matrix<double, 1, 1>(-1.0), Eigen::Matrix<double, 1, 1>(1.0), e,
                  1.0 / (link.radians * link.radians));
  }
  const Eigen::VectorXd step = equations.solve();
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    PlanePose& pose = poses[static_cast<std::size_t>(i + 1)];
    pose.heading = wrapped_angle(pose.heading + step[i]);
  }
}

// One Gauss-Newton step; returns the largest move.
double settle_poses(const CognitiveMap& map, Poses& poses) {
  Equations equations(map.size(), 3);
  for (const Link& link : map.links()) {
    const PlanePose& a = poses[static_cast<std::size_t>(link.from)];
    const PlanePose& b = poses[static_cast<std::size_t>(link.to)];
    const double c = std::cos(a.heading), s = std::sin(a.heading);
    const PlanePose seen = a.inverse() * b;
    const double w = 1.0 / (link.metres * link.metres), w_turn = 1.0 / (link.radians * link.radians);
    using Row = Eigen::Vector3d;
    equations.add(link.from, link.to, Row(-c, -s, seen.y), Row(c, s, 0.0), seen.x - link.motion.x, w);
    equations.add(link.from, link.to, Row(s, -c, -seen.x), Row(-s, c, 0.0), seen.y - link.motion.y, w);
    equations.add(link.from, link.to, Row(0.0, 0.0, -1.0), Row(0.0, 0.0, 1.0),
                  wrapped_angle(seen.heading - link.motion.heading), w_turn);
  }
  const Eigen::VectorXd step = equations.solve();
  double largest = 0.0;
  for (Eigen::Index i = 0; i + 2 < step.size(); i += 3) {
    PlanePose& pose = poses[static_cast<std::size_t>(i / 3 + 1)];
    pose = {pose.x + step[i], pose.y + step[i + 1], wrapped_angle(pose.heading + step[i + 2])};
    largest = std::max(largest, std::hypot(step[i], step[i + 1]));
  }
  return largest;
}

}  // namespace

RelaxationMode relaxation_mode(std::string_view name) {
  if (name == "paper") return RelaxationMode::paper;
  if (name == "mean") return RelaxationMode::mean;
  if (name == "settled") return RelaxationMode::settled;
  throw UsageError(fmt::format("relaxation: expected paper, mean or settled, found '{}'", name));
}

RelaxationSummary relax(CognitiveMap& map, const RelaxationSettings& settings) {
  RelaxationSummary summary;
  if (map.size() < 2 || map.links().empty()) return {.settled = true};
  Poses poses = poses_of(map);
  if (settings.mode == RelaxationMode::settled) {
    settle_headings(map, poses);
    for (; summary.sweeps < settings.iterations && !summary.settled; ++summary.sweeps)
      summary.settled = settle_poses(map, poses) < settings.settled;
    summary.settled = true;
  } else {
    for (; summary.sweeps < settings.sweeps && !summary.settled; ++summary.sweeps)
      summary.settled = sweep(map, settings, poses) < settings.settled;
  }
  constexpr double kFlownApart = 1e9;  // metres
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PlanePose& before = map.node(static_cast<int>(i)).pose;
    summary.largest_move =
        std::max(summary.largest_move, std::hypot(poses[i].x - before.x, poses[i].y - before.y));
  }
  if (!all_finite(poses) || !(summary.largest_move < kFlownApart)) {
    summary.settled = false;
    summary.flew_apart = true;
    summary.largest_move = 0.0;
    return summary;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) map.node(static_cast<int>(i)).pose = poses[i];
  return summary;
}

double disagreement(const CognitiveMap& map) {
  if (map.links().empty()) return 0.0;
  double sum = 0.0;
  for (const Link& link : map.links()) {
    const PlanePose e = disagreement_of(link, map.node(link.from).pose, map.node(link.to).pose);
    sum += e.x * e.x + e.y * e.y;
  }
  return std::sqrt(sum / static_cast<double>(map.links().size()));
}

}  // namespace penumbra::slam::brain
