// Cholesky's factor of a sparse symmetric positive definite matrix of 6 x 6 blocks, one for every pair of
// poses that see a point together.
//
//   P S P^T = L L^T,      for column j:   W_i  = S_ij - sum over k < j of L_ik L_jk^T,   i >= j
//                                         L_jj L_jj^T = W_j,    L_ij = W_i L_jj^-T
//
// P is the approximate minimum degree order of the poses (AMD), by which few blocks that are zero in S are
// not in L. Which those are is found once; factorise() may follow as often as the numbers change. Nothing is
// fused and sums have one order, so that the result is the same on every processor.
//
// Cost: a product of 6 x 6 blocks, 25 ns with AVX, for each (k, i, j) above, 6 to 10 times less than a factor
// by single numbers takes, whose indices outweigh the arithmetic. Memory: 288 bytes a block of L.
// Source: Davis, Direct Methods for Sparse Linear Systems (2006), chapters 4 (left-looking) and 7 (AMD).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/backend/block_products.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

class BlockCholesky {
 public:
  BlockCholesky() = default;
  // `columns[a]`: the blocks b >= a of row a of the upper triangle that may be other than zero, ascending, a
  // itself first.
  explicit BlockCholesky(const std::vector<std::vector<int>>& columns);

  // `blocks`: those of the upper triangle, row by row as announced. False where S is not positive definite to
  // working precision; solve() is then meaningless. `with_avx`: nothing else than a test says.
  bool factorise(const std::vector<Matrix6d>& blocks, bool with_avx = has_avx());
  // x of S x = b.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  std::size_t factor_blocks() const { return rows_.size(); }

 private:
  std::vector<int> order_;          // per column of L, which pose it is
  std::vector<std::size_t> begin_;  // per column, its first block: the diagonal; and the end of the last
  std::vector<int> rows_;           // per block, ascending within a column
  std::vector<Matrix6d> factor_;    // per block
  // Where the given blocks belong: per block of S, and whether it has to be transposed for it.
  std::vector<std::size_t> place_;
  std::vector<char> transposed_;
  // Per row j, the blocks (j, k) with k < j, from which on column k changes column j; and column k's end.
  std::vector<std::size_t> row_begin_;
  std::vector<std::size_t> row_blocks_;
  std::vector<std::size_t> row_ends_;
};

}  // namespace penumbra::slam
