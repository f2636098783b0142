#include "slam/backend/block_products.h"

#include <cstring>

namespace penumbra::slam {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;
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

}  // namespace penumbra::slam
