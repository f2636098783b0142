#include "slam/backend/block_products.h"

#include <cstring>

namespace penumbra::slam {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;
using FourNumbers [[gnu::vector_size(32)]] = double;
using TwoNumbers [[gnu::vector_size(16)]] = double;

// A block of K columns in registers.
template <int K>
struct Columns {
  [[gnu::always_inline]] explicit Columns(const double* block) {
    for (int k = 0; k < K; ++k) {
      std::memcpy(&upper[k], block + 6 * k, sizeof upper[k]);
      std::memcpy(&lower[k], block + 6 * k + 4, sizeof lower[k]);
    }
  }

  FourNumbers upper[K];
  TwoNumbers lower[K];
};

// block -= left right^T; `right`: 6 x K, `stride`: numbers from a column of the block to the next.
template <int K>
[[gnu::always_inline]] inline void subtract_product(const Columns<K>& left, const double* right,
                                                    double* block, std::ptrdiff_t stride) {
  for (int c = 0; c < 6; ++c, block += stride) {
    FourNumbers first = left.upper[0] * right[c];
    TwoNumbers last = left.lower[0] * right[c];
    for (int k = 1; k < K; ++k) {
      first += left.upper[k] * right[6 * k + c];
      last += left.lower[k] * right[6 * k + c];
    }
    FourNumbers four;
    TwoNumbers two;
    std::memcpy(&four, block, sizeof four);
    std::memcpy(&two, block + 4, sizeof two);
    four -= first;
    two -= last;
    std::memcpy(block, &four, sizeof four);
    std::memcpy(block + 4, &two, sizeof two);
  }
}

[[gnu::always_inline]] inline void subtract_row(const DenseBlocks& blocks, int a, const Matrix63& Y,
                                                const Matrix63* W, const std::vector<int>& slots) {
  const Columns<3> left(Y.data());
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const int b = slots[k];
    if (b < a) continue;
    subtract_product(left, W[k].data(), blocks.corner + 6 * a + 6 * b * blocks.stride, blocks.stride);
  }
}

[[gnu::always_inline]] inline void subtract_column(Matrix6d* factor, std::size_t first, std::size_t end,
                                                   const int* rows, const std::size_t* place) {
  const Matrix6d right = factor[first];  // a copy: the compiler need not expect it to change
  for (std::size_t b = first; b < end; ++b)
    subtract_product(Columns<6>(factor[b].data()), right.data(), factor[place[rows[b]]].data(), 6);
}

#if defined(__x86_64__)
[[gnu::target("avx")]]
#endif
void subtract_column_with_avx(Matrix6d* factor, std::size_t first, std::size_t end, const int* rows,
                           const std::size_t* place) {
  subtract_column(factor, first, end, rows, place);
}

#if defined(__x86_64__)
[[gnu::target("avx")]]
#endif
void subtract_row_with_avx(const DenseBlocks& blocks, int a, const Matrix63& Y,
                                              const Matrix63* W, const std::vector<int>& slots) {
  subtract_row(blocks, a, Y, W, slots);
}

}  // namespace

void subtract_products(const DenseBlocks& blocks, int a, const Matrix63& Y, const Matrix63* W,
                       const std::vector<int>& slots, bool with_avx) {
  if (with_avx) {
    subtract_row_with_avx(blocks, a, Y, W, slots);
  } else {
    subtract_row(blocks, a, Y, W, slots);
  }
}

void subtract_outer(Matrix6d* factor, std::size_t first, std::size_t end, const int* rows,
                    const std::size_t* place, bool with_avx) {
  if (with_avx) {
    subtract_column_with_avx(factor, first, end, rows, place);
  } else {
    subtract_column(factor, first, end, rows, place);
  }
}

}  // namespace penumbra::slam
