// The equations of the poses that are left when bundle adjustment has eliminated the points: S dx = b with a
// symmetric S of 6 x 6 blocks, one for every pair of poses that see a point together.
//
// In a local window everybody sees everything: S is stored and factorised densely. Along a drive a keyframe
// shares points with a few dozen others: beyond kDensePoses poses only the blocks that occur are stored, and
// the factor is sparse, too (block_cholesky.h). Cost for n poses with a band of m blocks: O(n m^2) instead of
// O(n^3); memory O(n m) instead of O(n^2).
//
// S is a sum over points. Several threads can form it, each its own part; the parts are added in their order,
// so that the result does not depend on who was first.
// Source: Triggs et al., Bundle Adjustment - A Modern Synthesis (2000), section 6.2.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "slam/backend/block_cholesky.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

class ReducedCameraSystem {
 public:
  static constexpr int kDensePoses = 40;

  // `neighbours[a]`: the poses b >= a that share a point with a, a itself included; in any order, repetitions
  // allowed. Only read where the system is sparse.
  explicit ReducedCameraSystem(int poses, std::vector<std::vector<int>> neighbours = {}, int parts = 1);

  bool sparse() const { return sparse_; }
  void set_zero(int part = 0);
  // Block (a, b) of the upper triangle, a <= b; of the pairs that were announced.
  Eigen::Ref<Matrix6d, 0, Eigen::OuterStride<>> block(int a, int b, int part = 0);
  // Of the sum of all parts, which is then in the first. False where S is not positive definite to working
  // precision.
  bool factorise();
  // dx of the S that was factorised.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  int poses_ = 0;
  bool sparse_ = false;
  std::vector<Eigen::MatrixXd> dense_;  // per part
  Eigen::LDLT<Eigen::MatrixXd, Eigen::Upper> dense_cholesky_;
  std::vector<std::vector<int>> columns_;      // per row, ascending
  std::vector<int> first_block_;               // per row, its first block in blocks_
  std::vector<std::vector<Matrix6d>> blocks_;  // per part
  BlockCholesky cholesky_;
};

}  // namespace penumbra::slam
