// Winograd's two transforms of F(4x4, 3x3), 16 channels at a time: kernel_table.h says what they compute,
// docs/engine/winograd.md where the numbers come from.

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kOut = kWinogradOutput, kIn = kWinogradInput;

// The finite points of the transform besides 0, and their powers; all exact.
constexpr float kA = kWinogradA, kA2 = kA * kA, kA3 = kA2 * kA;
constexpr float kB = kWinogradB, kB2 = kB * kB, kB3 = kB2 * kB;
constexpr float kSum = kA2 + kB2, kProduct = kA2 * kB2;

// o = B^T d:
//    a^2b^2     0  -a^2-b^2    0      1      0
//        0  -ab^2   -b^2       a      1      0
//        0   ab^2   -b^2      -a      1      0
//        0  -a^2b   -a^2       b      1      0
//        0   a^2b   -a^2      -b      1      0
//        0  a^2b^2     0  -a^2-b^2    0      1
__attribute__((always_inline)) inline void transform_input(const Vector* d, Vector (&o)[kIn]) {
  const Vector a(kA), minus_a(-kA), b(kB), minus_b(-kB), minus_a2(-kA2), minus_b2(-kB2), product(kProduct),
      minus_sum(-kSum);
  const Vector even_a = madd(minus_b2, d[2], d[4]), odd_a = madd(minus_b2, d[1], d[3]);
  const Vector even_b = madd(minus_a2, d[2], d[4]), odd_b = madd(minus_a2, d[1], d[3]);
  o[0] = madd(product, d[0], madd(minus_sum, d[2], d[4]));
  o[1] = madd(a, odd_a, even_a);
  o[2] = madd(minus_a, odd_a, even_a);
  o[3] = madd(b, odd_b, even_b);
  o[4] = madd(minus_b, odd_b, even_b);
  o[5] = madd(product, d[1], madd(minus_sum, d[3], d[5]));
}

// o = A^T m:
//        1    1    1    1    1    0
//        0    a   -a    b   -b    0
//        0  a^2  a^2  b^2  b^2    0
//        0  a^3 -a^3  b^3 -b^3    1
__attribute__((always_inline)) inline void transform_output(const Vector* m, Vector (&o)[kOut]) {
  const Vector a(kA), a2(kA2), a3(kA3), b(kB), b2(kB2), b3(kB3);
  const Vector sum_a = m[1] + m[2], difference_a = m[1] - m[2];
  const Vector sum_b = m[3] + m[4], difference_b = m[3] - m[4];
  o[0] = m[0] + (sum_a + sum_b);
  o[1] = madd(a, difference_a, b * difference_b);
  o[2] = madd(a2, sum_a, b2 * sum_b);
  o[3] = madd(a3, difference_a, madd(b3, difference_b, m[5]));
}

}  // namespace

void winograd_input(const WinogradInputArguments& a) {
  for (int t = 0; t < a.tiles; ++t) {
    for (int lane = 0; lane < kBlockLanes; lane += kLanes) {
      const float* in = a.input + t * kOut * kBlockLanes + lane;
      float* out = a.output + t * kBlockLanes + lane;
      Vector columns[kIn * kIn];  // B^T d, row by row
#pragma GCC unroll 6
      for (int j = 0; j < kIn; ++j) {
        Vector d[kIn], o[kIn];
#pragma GCC unroll 6
        for (int i = 0; i < kIn; ++i) d[i] = Vector::load_unaligned(in + i * a.row_stride + j * kBlockLanes);
        transform_input(d, o);
#pragma GCC unroll 6
        for (int i = 0; i < kIn; ++i) columns[i * kIn + j] = o[i];
      }
#pragma GCC unroll 6
      for (int i = 0; i < kIn; ++i) {
        Vector o[kIn];
        transform_input(columns + i * kIn, o);
#pragma GCC unroll 6
        for (int j = 0; j < kIn; ++j) o[j].store_unaligned(out + (i * kIn + j) * a.position_stride);
      }
    }
  }
}

void winograd_output(const WinogradOutputArguments& a) {
  const Vector lower_bound(a.lower_bound);
  for (int t = 0; t < a.tiles; ++t) {
    const int columns = a.columns - t * kOut < kOut ? a.columns - t * kOut : kOut;
    for (int lane = 0; lane < kBlockLanes; lane += kLanes) {
      const float* in = a.input + t * kBlockLanes + lane;
      const std::ptrdiff_t first = t * kOut * kBlockLanes + lane;
      const Vector bias = Vector::load_unaligned(a.bias + lane);
      Vector rows[kOut * kIn];  // A^T M, row by row
#pragma GCC unroll 6
      for (int j = 0; j < kIn; ++j) {
        Vector m[kIn], o[kOut];
#pragma GCC unroll 6
        for (int i = 0; i < kIn; ++i) m[i] = Vector::load_unaligned(in + (i * kIn + j) * a.position_stride);
        transform_output(m, o);
#pragma GCC unroll 4
        for (int i = 0; i < kOut; ++i) rows[i * kIn + j] = o[i];
      }
#pragma GCC unroll 4
      for (int i = 0; i < kOut; ++i) {
        if (i >= a.rows) break;
        Vector o[kOut];
        transform_output(rows + i * kIn, o);
        float* out = a.output + first + i * a.output_row_stride;
        const float* residual =
            a.residual == nullptr ? nullptr : a.residual + first + i * a.residual_row_stride;
#pragma GCC unroll 4
        for (int j = 0; j < kOut; ++j) {
          if (j >= columns) break;
          Vector y = o[j] + bias;
          if (residual != nullptr) y += Vector::load_unaligned(residual + j * kBlockLanes);
          // In this order the instruction keeps a NaN of y.
          max(lower_bound, y).store_unaligned(out + j * kBlockLanes);
        }
      }
    }
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
