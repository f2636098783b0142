#include "slam/backend/block_products.h"

#include <cstring>

namespace penumbra::slam {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Matrix66 = Eigen::Matrix<double, 6, 6>;
using FourNumbers [[gnu::vector_size(32)]] = double;
using TwoNumbers [[gnu::vector_size(16)]] = double;

[[gnu::always_inline]] inline void subtract(const DenseBlocks& blocks, int a, const Matrix63& Y,
                                            const Matrix63* W, const std::vector<int>& slots) {
  FourNumbers upper[3];
  TwoNumbers lower[3];
  for (int c = 0; c < 3; ++c) {
    std::memcpy(&upper[c], Y.data() + 6 * c, sizeof upper[c]);
    std::memcpy(&lower[c], Y.data() + 6 * c + 4, sizeof lower[c]);
  }
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const int b = slots[k];
    if (b < a) continue;
    const double* w = W[k].data();
    double* column = blocks.corner + 6 * a + 6 * b * blocks.stride;
    for (int c = 0; c < 6; ++c, column += blocks.stride) {
      FourNumbers first;
      TwoNumbers last;
      std::memcpy(&first, column, sizeof first);
      std::memcpy(&last, column + 4, sizeof last);
      first -= (upper[0] * w[c] + upper[1] * w[c + 6]) + upper[2] * w[c + 12];
      last -= (lower[0] * w[c] + lower[1] * w[c + 6]) + lower[2] * w[c + 12];
      std::memcpy(column, &first, sizeof first);
      std::memcpy(column + 4, &last, sizeof last);
    }
  }
}

[[gnu::always_inline]] inline void subtract_all(Matrix66* factor, std::size_t first, std::size_t end,
                                                const int* rows, const std::size_t* place) {
  const Matrix66 right = factor[first];
  for (std::size_t b = first; b < end; ++b) {
    FourNumbers upper[6];
    TwoNumbers lower[6];
    const double* left = factor[b].data();
    for (int k = 0; k < 6; ++k) {
      std::memcpy(&upper[k], left + 6 * k, sizeof upper[k]);
      std::memcpy(&lower[k], left + 6 * k + 4, sizeof lower[k]);
    }
    double* column = factor[place[rows[b]]].data();
    for (int c = 0; c < 6; ++c, column += 6) {
      FourNumbers first_four = upper[0] * right(c, 0);
      TwoNumbers last_two = lower[0] * right(c, 0);
      for (int k = 1; k < 6; ++k) {
        first_four += upper[k] * right(c, k);
        last_two += lower[k] * right(c, k);
      }
      FourNumbers four;
      TwoNumbers two;
      std::memcpy(&four, column, sizeof four);
      std::memcpy(&two, column + 4, sizeof two);
      four -= first_four;
      two -= last_two;
      std::memcpy(column, &four, sizeof four);
      std::memcpy(column + 4, &two, sizeof two);
    }
  }
}

#if defined(__x86_64__)
[[gnu::target("avx")]]
#endif
void subtract_all_with_avx(Matrix66* factor, std::size_t first, std::size_t end, const int* rows,
                           const std::size_t* place) {
  subtract_all(factor, first, end, rows, place);
}

#if defined(__x86_64__)
[[gnu::target("avx")]]
#endif
void subtract_with_avx(const DenseBlocks& blocks, int a, const Matrix63& Y,
                                              const Matrix63* W, const std::vector<int>& slots) {
  subtract(blocks, a, Y, W, slots);
}

}  // namespace

void subtract_products(const DenseBlocks& blocks, int a, const Matrix63& Y, const Matrix63* W,
                       const std::vector<int>& slots, bool with_avx) {
  if (with_avx) {
    subtract_with_avx(blocks, a, Y, W, slots);
  } else {
    subtract(blocks, a, Y, W, slots);
  }
}

void subtract_outer(Matrix66* factor, std::size_t first, std::size_t end, const int* rows,
                    const std::size_t* place, bool with_avx) {
  if (with_avx) {
    subtract_all_with_avx(factor, first, end, rows, place);
  } else {
    subtract_all(factor, first, end, rows, place);
  }
}

}  // namespace penumbra::slam
