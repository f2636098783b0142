// The products by which a point is taken out of the equations of the poses, half of the time of a small
// bundle adjustment, and those of a sparse Cholesky factor of the poses, most of that of a large one.
//
//   S_ab -= Y_a W_b^T,      Y, W: 6 x 3
//   L_ij -= L_ik L_jk^T,          6 x 6     (block_cholesky.h)
//
// Six rows are a register of four numbers and one of two. With AVX the first is one register, without it (and
// on ARM) two; nothing is fused, so that the result is the same on every processor. Cost: 12 and 25 ns a
// block with AVX.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

// A matrix of 6 x 6 blocks, column by column.
struct DenseBlocks {
  double* corner = nullptr;   // of block (0, 0)
  std::ptrdiff_t stride = 0;  // numbers from a column to the next
};

#if defined(__x86_64__)
inline bool has_avx() { return __builtin_cpu_supports("avx") != 0; }
#else
inline bool has_avx() { return false; }
#endif

// Subtracts Y W[k]^T from block (a, slots[k]) for every k with slots[k] >= a: of the upper triangle.
// `with_avx`: nothing else than a test says.
void subtract_products(const DenseBlocks& blocks, int a, const Eigen::Matrix<double, 6, 3>& Y,
                       const Eigen::Matrix<double, 6, 3>* W, const std::vector<int>& slots,
                       bool with_avx = has_avx());

// Subtracts factor[b] factor[first]^T from factor[place[rows[b]]] for every b from `first` to `end`, 6 x 6
// blocks column by column. None of those that are changed is among those that are read.
void subtract_outer(Matrix6d* factor, std::size_t first, std::size_t end, const int* rows,
                    const std::size_t* place, bool with_avx);

}  // namespace penumbra::slam
