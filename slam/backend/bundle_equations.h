// The normal equations of a bundle adjustment, and their solution.
//
// With the unknowns ordered poses first, points second they are
//
//   [ U    W ] [ dx ]     [ g_x ]          U: 6x6 blocks on the diagonal, one per free pose
//   [ W^T  V ] [ dX ] = - [ g_X ]          V: 3x3 blocks on the diagonal, one per point
//
// and since V is block diagonal the points can be eliminated (Schur complement):
//
//   (U - W V^-1 W^T) dx = -g_x + W V^-1 g_X,        dX = -V^-1 (g_X + W^T dx)
//
// Damping: the diagonals of U and V are multiplied by 1 + lambda. Perturbation T <- exp(dx) T on the left.
//
// The disparity offset d0 of the stereo camera may be one more unknown: it borders the equations of the poses
// with a column s and a number c, which lose what the points explain just as U does. With one factorisation,
//
//   S = U - W V^-1 W^T,   S x = right,   S y = s,      dd0 = (r - s^T x) / (c - s^T y),   dx = x - y dd0
//
// A prior keeps d0 by 0 where the measurements say nothing about it.
//
// Several threads share the points of a large problem, in kBundleParts parts whose sums are added in a fixed
// order: the result is the same for any number of threads, to the last bit. Cost of a solution:
// O(observations * observations per point) for the elimination, O((6 poses)^3) to solve, or much less where
// poses share points with few others (reduced_camera_system.h). Source: Triggs et al., Bundle Adjustment - A
// Modern Synthesis (2000), section 6; Lourakis, Argyros, SBA (2009).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "slam/backend/reduced_camera_system.h"
#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

inline constexpr int kBundleParts = 4;
// Observations from which on threads are worth their start: a few milliseconds an iteration.
inline constexpr std::size_t kBundleWorthThreads = 20000;

struct BundleObservation {
  int pose = 0, point = 0;  // indices
  PixelMeasurement measurement;
  bool active = true;  // others are left out
};

struct BundleProblem {
  StereoCamera camera;
  std::vector<SE3> poses;        // T_cw
  std::vector<char> pose_fixed;  // per pose
  std::vector<Eigen::Vector3d> points;
  std::vector<BundleObservation> observations;  // ordered by point
  // Pixels, deviation of the camera's disparity offset from 0 before anything is measured; 0: not adjusted.
  double disparity_offset_sigma = 0.0;
};

// One solution of the damped equations.
struct BundleStep {
  std::vector<Vector6d> poses;  // zero for fixed ones
  std::vector<Eigen::Vector3d> points;
  double disparity_offset = 0.0;
};

class BundleEquations {
 public:
  // Of `problem`, which must outlive them and keep its structure.
  BundleEquations(const BundleProblem& problem, bool robust, int threads);

  // What the adjustment minimises, of other values for the unknowns.
  double cost(const StereoCamera& camera, const std::vector<SE3>& poses,
              const std::vector<Eigen::Vector3d>& points);
  // U, V, W and the gradients at the problem's present state.
  void linearize();
  // Solves the damped equations; false where they are singular.
  bool solve(double lambda, BundleStep& step);

 private:
  using Matrix63 = Eigen::Matrix<double, 6, 3>;

  // The row and column of the disparity offset in the equations of the poses.
  struct Border {
    Eigen::VectorXd s;            // per pose
    double c = 0.0, right = 0.0;  // its own diagonal and right side

    explicit Border(int free_poses = 0) : s(Eigen::VectorXd::Zero(6 * free_poses)) {}
    void add(const Border& other) {
      s += other.s;
      c += other.c;
      right += other.right;
    }
  };
  // What one part of the points contributes to the sums over all.
  struct Part {
    std::size_t begin = 0, end = 0;  // points
    double cost = 0.0;
    std::vector<Matrix6d> U;
    Eigen::VectorXd g_poses, right;
    Border border, eliminated;  // before the points are eliminated, and what that changes
  };

  template <typename Work>
  void for_each_part(Work&& work);
  bool adjusts_offset() const { return problem_.disparity_offset_sigma > 0.0; }
  double prior() const;  // 1/pixels^2
  double bound(const PixelMeasurement& z) const;
  // Slot of the observation's pose among the free ones; -1 for a fixed pose or an observation that is left
  // out.
  int free_slot(std::size_t i) const;
  void linearize_observation(std::size_t i, std::size_t j, Part& part);
  // Per free pose the free poses behind it with which it shares a point; empty where nobody needs to know.
  std::vector<std::vector<int>> neighbours() const;
  // Takes point j out of the equations of the poses.
  void eliminate(std::size_t j, double lambda, Part& part, int number);
  // dX of point j, given dx and dd0.
  Eigen::Vector3d point_step(std::size_t j, const Eigen::VectorXd& dx, double disparity_offset) const;

  const BundleProblem& problem_;
  const bool robust_;
  const int threads_;
  int free_poses_ = 0;
  std::vector<int> slot_;   // pose -> place among the free ones; -1 where it is fixed
  std::vector<int> begin_;  // point -> its first observation; one more at the end
  std::vector<Matrix6d> U_;
  std::vector<Eigen::Matrix3d> V_, V_inverse_;
  std::vector<Matrix63> W_;  // per observation
  std::unique_ptr<ReducedCameraSystem> reduced_;
  std::array<Part, kBundleParts> parts_;
  Eigen::VectorXd g_poses_;
  std::vector<Eigen::Vector3d> g_points_;
  std::vector<Eigen::Vector3d> offset_points_;  // per point: the disparity offset's block beside V
  Border border_;
};

}  // namespace penumbra::slam
