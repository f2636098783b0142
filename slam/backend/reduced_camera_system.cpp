#include "slam/backend/reduced_camera_system.h"

#include <algorithm>

namespace penumbra::slam {

ReducedCameraSystem::ReducedCameraSystem(int poses, std::vector<std::vector<int>> neighbours, int parts)
    : poses_(poses), sparse_(poses > kDensePoses), columns_(std::move(neighbours)) {
  if (!sparse_) {
    dense_.assign(static_cast<std::size_t>(parts), Eigen::MatrixXd(6 * poses, 6 * poses));
    columns_.clear();
    return;
  }
  columns_.resize(static_cast<std::size_t>(poses));
  first_block_.assign(1, 0);
  for (int a = 0; a < poses; ++a) {
    std::vector<int>& row = columns_[static_cast<std::size_t>(a)];
    row.push_back(a);
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    first_block_.push_back(first_block_.back() + static_cast<int>(row.size()));
  }
  blocks_.assign(static_cast<std::size_t>(parts),
                 std::vector<Matrix6d>(static_cast<std::size_t>(first_block_.back())));
  cholesky_ = BlockCholesky(columns_);
}

void ReducedCameraSystem::set_zero(int part) {
  if (sparse_) {
    for (Matrix6d& block : blocks_[static_cast<std::size_t>(part)]) block.setZero();
  } else {
    dense_[static_cast<std::size_t>(part)].setZero();
  }
}

Eigen::Ref<Matrix6d, 0, Eigen::OuterStride<>> ReducedCameraSystem::block(int a, int b, int part) {
  if (!sparse_) return dense_[static_cast<std::size_t>(part)].block<6, 6>(6 * a, 6 * b);
  const std::vector<int>& row = columns_[static_cast<std::size_t>(a)];
  const auto at = std::lower_bound(row.begin(), row.end(), b) - row.begin();
  return blocks_[static_cast<std::size_t>(part)]
                [static_cast<std::size_t>(first_block_[static_cast<std::size_t>(a)] + at)];
}

bool ReducedCameraSystem::factorise() {
  if (poses_ == 0) return true;
  if (!sparse_) {
    for (std::size_t p = 1; p < dense_.size(); ++p) dense_.front() += dense_[p];
    dense_cholesky_.compute(dense_.front());
    return dense_cholesky_.info() == Eigen::Success;
  }
  for (std::size_t p = 1; p < blocks_.size(); ++p) {
    for (std::size_t b = 0; b < blocks_[p].size(); ++b) blocks_.front()[b] += blocks_[p][b];
  }
  return cholesky_.factorise(blocks_.front());
}

Eigen::VectorXd ReducedCameraSystem::solve(const Eigen::VectorXd& right) const {
  if (poses_ == 0) return right;
  if (sparse_) return cholesky_.solve(right);
  return dense_cholesky_.solve(right);
}

}  // namespace penumbra::slam
