// Naive max_pool and add_upsampled.
#include <algorithm>
#include <limits>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

Tensor max_pool(const Tensor& x, const PoolOptions& options) {
  const auto [kernel, stride, padding] = options;
  const std::int64_t height = x.extent(2), width = x.extent(3);
  Tensor y({x.extent(0), x.extent(1), (height + 2 * padding - kernel) / stride + 1,
            (width + 2 * padding - kernel) / stride + 1});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < y.extent(2); ++i) {
        for (std::int64_t j = 0; j < y.extent(3); ++j) {
          float best = -std::numeric_limits<float>::infinity();
          for (int u = 0; u < kernel; ++u) {
            for (int v = 0; v < kernel; ++v) {
              const std::int64_t row = i * stride - padding + u, column = j * stride - padding + v;
              if (row < 0 || column < 0 || row >= height || column >= width) continue;
              best = std::max(best, x.at(n, c, row, column));
            }
          }
          y.at(n, c, i, j) = best;
        }
      }
    }
  }
  return y;
}

Tensor add_upsampled(const Tensor& x, const Tensor& y) {
  Tensor sum = y;
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < y.extent(2); ++i) {
        for (std::int64_t j = 0; j < y.extent(3); ++j) {
          sum.at(n, c, i, j) += x.at(n, c, i * x.extent(2) / y.extent(2), j * x.extent(3) / y.extent(3));
        }
      }
    }
  }
  return sum;
}

}  // namespace penumbra::nn::reference
