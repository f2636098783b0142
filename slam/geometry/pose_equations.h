// What one reprojection adds to the normal equations of a pose: the products of its Jacobian.
//
//   H += w J^T J,   g += w J^T e,   W = w J^T J_point        J = J_pose, 3 x 6, of reprojection.h
//
// J's columns 0 and 1 have one zero row or two (a pixel's column does not depend on y, nor its row on x), and
// of H, which is symmetric, the upper triangle is enough: half of the multiplications that the products as
// they stand take, with the same sums in the same order, two rows at a time. Cost: 25 ns.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstring>

#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

class PoseEquations {
 public:
  // `J_pi`: de/dp of a point `p` in the camera's frame; w: its weight.
  PoseEquations(const Eigen::Matrix3d& J_pi, const Eigen::Vector3d& p, double w)
      : u_{J_pi(0, 0),         0.0, J_pi(0, 2), p.y() * J_pi(0, 2), p.z() * J_pi(0, 0) - p.x() * J_pi(0, 2),
           -p.y() * J_pi(0, 0)},
        v_{0.0,
           J_pi(1, 1),
           J_pi(1, 2),
           p.y() * J_pi(1, 2) - p.z() * J_pi(1, 1),
           -p.x() * J_pi(1, 2),
           p.x() * J_pi(1, 1)},
        r_{J_pi(2, 0),         0.0, J_pi(2, 2), p.y() * J_pi(2, 2), p.z() * J_pi(2, 0) - p.x() * J_pi(2, 2),
           -p.y() * J_pi(2, 0)} {
    for (std::size_t k = 0; k < 3; ++k) {
      weighted_u_[k] = w * Pair{u_[2 * k], u_[2 * k + 1]};
      weighted_v_[k] = w * Pair{v_[2 * k], v_[2 * k + 1]};
      weighted_r_[k] = w * Pair{r_[2 * k], r_[2 * k + 1]};
    }
  }

  // To a triangle of H, 6 columns one after the other; what is beyond the diagonal means nothing. (The two
  // are not equal to the last bit: the weight goes with the row.)
  void add_upper_hessian(double* H) const {
    add(H, u_of_column_0(0));
    add(H + 6, v_of_column_1(0));
    for (const std::size_t column : {2, 3, 4, 5}) {
      add(H + 6 * column, product_with_column(0, column));
      add(H + 6 * column + 2, product_with_column(1, column));
      if (column >= 4) add(H + 6 * column + 4, product_with_column(2, column));
    }
  }
  void add_lower_hessian(double* H) const {
    for (const std::size_t k : {0, 1, 2}) {
      add(H + 2 * k, u_of_column_0(k));
      add(H + 6 + 2 * k, v_of_column_1(k));
    }
    for (const std::size_t column : {2, 3, 4, 5}) {
      if (column < 4) add(H + 6 * column + 2, product_with_column(1, column));
      add(H + 6 * column + 4, product_with_column(2, column));
    }
  }
  // To the 6 entries of g.
  void add_gradient(const Eigen::Vector3d& e, double* g) const {
    for (std::size_t k = 0; k < 3; ++k) add(g + 2 * k, product(k, e[0], e[1], e[2]));
  }
  Eigen::Matrix<double, 6, 3> cross(const Eigen::Matrix3d& J_point) const {
    Eigen::Matrix<double, 6, 3> W;
    for (int column = 0; column < 3; ++column) {
      for (std::size_t k = 0; k < 3; ++k) {
        put(W.data() + 6 * column + 2 * k,
            product(k, J_point(0, column), J_point(1, column), J_point(2, column)));
      }
    }
    return W;
  }
  // w times the row of J of the right image's column.
  Vector6d weighted_right_row() const {
    Vector6d row;
    for (std::size_t k = 0; k < 3; ++k) put(row.data() + 2 * k, weighted_r_[k]);
    return row;
  }

 private:
  using Pair [[gnu::vector_size(16)]] = double;  // stays in a register, where an Eigen::Array2d does not

  static void put(double* to, const Pair& terms) { std::memcpy(to, &terms, sizeof terms); }
  static void add(double* to, const Pair& terms) {
    Pair sum;
    std::memcpy(&sum, to, sizeof sum);
    put(to, sum + terms);
  }
  // Rows 2 k and 2 k + 1 of w J^T J: column 0, where J has no v, and 1, where it has nothing else.
  Pair u_of_column_0(std::size_t k) const { return weighted_u_[k] * u_[0] + weighted_r_[k] * r_[0]; }
  Pair v_of_column_1(std::size_t k) const { return weighted_v_[k] * v_[1]; }
  Pair product_with_column(std::size_t k, std::size_t column) const {
    return product(k, u_[column], v_[column], r_[column]);
  }
  // The same of w J^T times a column (a, b, c).
  Pair product(std::size_t k, double a, double b, double c) const {
    return (weighted_u_[k] * a + weighted_v_[k] * b) + weighted_r_[k] * c;
  }

  std::array<double, 6> u_, v_,
      r_;  // J's rows: of the column and the row in the left image, the column in the right
  std::array<Pair, 3> weighted_u_, weighted_v_, weighted_r_;
};

}  // namespace penumbra::slam
