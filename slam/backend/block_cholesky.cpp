#include "slam/backend/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <iterator>
#include <utility>

namespace penumbra::slam {

namespace {

std::vector<int> minimum_degree_order(const std::vector<std::vector<int>>& columns) {
  const auto n = static_cast<int>(columns.size());
  std::vector<Eigen::Triplet<char>> entries;
  for (int a = 0; a < n; ++a) {
    for (const int b : columns[static_cast<std::size_t>(a)]) {
      entries.emplace_back(a, b, 1);
      if (a != b) entries.emplace_back(b, a, 1);
    }
  }
  Eigen::SparseMatrix<char> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  return {order.indices().data(), order.indices().data() + n};
}

// The rows of each column of L: those of S below the diagonal, and those of every column whose first row
// below its own diagonal this is (Davis, section 4.1: its children in the elimination tree).
std::vector<std::vector<int>> rows_of_factor(std::vector<std::vector<int>> rows) {
  const std::size_t n = rows.size();
  std::vector<std::vector<int>> children(n);
  std::vector<int> merged;
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<int>& own = rows[j];
    std::sort(own.begin(), own.end());
    for (const int child : children[j]) {
      const std::vector<int>& below = rows[static_cast<std::size_t>(child)];
      merged.clear();
      std::set_union(own.begin(), own.end(), below.begin() + 1, below.end(), std::back_inserter(merged));
      own.swap(merged);
    }
    if (own.size() > 1) children[static_cast<std::size_t>(own[1])].push_back(static_cast<int>(j));
  }
  return rows;
}

}  // namespace

BlockCholesky::BlockCholesky(const std::vector<std::vector<int>>& columns)
    : order_(minimum_degree_order(columns)) {
  const std::size_t n = columns.size();
  std::vector<int> at(n);  // per pose, its column
  for (std::size_t j = 0; j < n; ++j) at[static_cast<std::size_t>(order_[j])] = static_cast<int>(j);
  // Column and row of L's block for a pair of poses.
  const auto block_of = [&](std::size_t a, int b) {
    return std::minmax(at[a], at[static_cast<std::size_t>(b)]);
  };
  std::vector<std::vector<int>> rows(n);
  for (std::size_t a = 0; a < n; ++a) {
    for (const int b : columns[a]) {
      const auto [j, i] = block_of(a, b);
      rows[static_cast<std::size_t>(j)].push_back(i);
    }
  }
  rows = rows_of_factor(std::move(rows));
  begin_.assign(1, 0);
  std::vector<std::size_t> in_row(n + 1, 0);
  for (const std::vector<int>& column : rows) {
    begin_.push_back(begin_.back() + column.size());
    rows_.insert(rows_.end(), column.begin(), column.end());
    for (std::size_t i = 1; i < column.size(); ++i) ++in_row[static_cast<std::size_t>(column[i]) + 1];
  }
  factor_.resize(rows_.size());

  for (std::size_t i = 0; i < n; ++i) in_row[i + 1] += in_row[i];
  row_begin_ = in_row;
  row_blocks_.resize(row_begin_.back());
  row_ends_.resize(row_begin_.back());
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t block = begin_[k] + 1; block < begin_[k + 1]; ++block) {
      const std::size_t slot = in_row[static_cast<std::size_t>(rows_[block])]++;
      row_blocks_[slot] = block;
      row_ends_[slot] = begin_[k + 1];
    }
  }

  for (std::size_t a = 0; a < n; ++a) {
    for (const int b : columns[a]) {
      const auto [j, i] = block_of(a, b);
      const auto column = begin_.begin() + j;
      const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(column[0]);
      const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(column[1]);
      place_.push_back(static_cast<std::size_t>(std::lower_bound(begin, end, i) - rows_.begin()));
      // (a, b) is L's block of row b, column a where a comes first: transposed.
      transposed_.push_back(at[a] < i);
    }
  }
}

bool BlockCholesky::factorise(const std::vector<Matrix6d>& blocks, bool with_avx) {
  for (Matrix6d& block : factor_) block.setZero();
  for (std::size_t s = 0; s < blocks.size(); ++s) {
    if (transposed_[s])
      factor_[place_[s]] = blocks[s].transpose();
    else
      factor_[place_[s]] = blocks[s];
  }
  std::vector<std::size_t> place(order_.size());  // per row, its block in the column that is being made
  for (std::size_t j = 0; j < order_.size(); ++j) {
    for (std::size_t block = begin_[j]; block < begin_[j + 1]; ++block)
      place[static_cast<std::size_t>(rows_[block])] = block;
    for (std::size_t slot = row_begin_[j]; slot < row_begin_[j + 1]; ++slot) {
      subtract_outer(factor_.data(), row_blocks_[slot], row_ends_[slot], rows_.data(), place.data(),
                     with_avx);
    }
    Matrix6d& pivot = factor_[begin_[j]];
    // The upper triangle alone: of the blocks that were given nobody looks below the diagonal.
    const Eigen::LLT<Matrix6d, Eigen::Upper> cholesky(pivot);
    const Matrix6d upper = cholesky.matrixU();
    if (cholesky.info() != Eigen::Success || !upper.allFinite()) return false;
    pivot = upper.transpose();
    for (std::size_t block = begin_[j] + 1; block < begin_[j + 1]; ++block)
      upper.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(factor_[block]);
  }
  return true;
}

Eigen::VectorXd BlockCholesky::solve(const Eigen::VectorXd& right) const {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  const auto n = static_cast<Eigen::Index>(order_.size());
  Rows y(6, n);
  for (Eigen::Index j = 0; j < n; ++j) y.col(j) = right.segment<6>(6 * order_[static_cast<std::size_t>(j)]);
  for (std::size_t j = 0; j < order_.size(); ++j) {
    auto own = y.col(static_cast<Eigen::Index>(j));
    factor_[begin_[j]].triangularView<Eigen::Lower>().solveInPlace(own);
    for (std::size_t block = begin_[j] + 1; block < begin_[j + 1]; ++block)
      y.col(rows_[block]).noalias() -= factor_[block] * own;
  }
  for (std::size_t j = order_.size(); j-- > 0;) {
    auto own = y.col(static_cast<Eigen::Index>(j));
    for (std::size_t block = begin_[j] + 1; block < begin_[j + 1]; ++block)
      own.noalias() -= factor_[block].transpose() * y.col(rows_[block]);
    factor_[begin_[j]].transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
  Eigen::VectorXd x(6 * n);
  for (Eigen::Index j = 0; j < n; ++j) x.segment<6>(6 * order_[static_cast<std::size_t>(j)]) = y.col(j);
  return x;
}

}  // namespace penumbra::slam
