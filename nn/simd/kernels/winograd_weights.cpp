// Winograd's transform of weights, G g G^T: kernel_table.h says what it computes, docs/engine/winograd.md
// where the numbers come from.
//
// In f64 and rounded once, so that the transform adds nothing to the error of the products. This file is
// compiled without fused multiply-adds: every instruction set gives the same bits.

#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kIn = kWinogradInput;
// Output channels at a time: whole cache lines of results where there are registers for them.
#ifdef __AVX512F__
constexpr int kLanes = 16;
#else
constexpr int kLanes = 8;
#endif

// G takes a kernel's 3 numbers to 6: (1, p, p^2) / N_p for each point p; the rows of +-a, and of +-b, differ
// in the sign of the middle.
constexpr double kA = kWinogradA, kB = kWinogradB, kA2 = kA * kA, kB2 = kB * kB;
constexpr double kN0 = kA2 * kB2, kNa = 2 * kA2 * (kA2 - kB2), kNb = 2 * kB2 * (kB2 - kA2);

// o = G g, of kLanes kernels; `g` and `o` are `step` numbers from one of the 3 or 6 to the next.
__attribute__((always_inline)) inline void transform(const double (*g)[kLanes], int step, double (*o)[kLanes],
                                                     int o_step) {
  for (int l = 0; l < kLanes; ++l) {
    const double g0 = g[0][l], g1 = g[step][l], g2 = g[2 * step][l];
    const double a0 = 1 / kNa * g0, a1 = kA / kNa * g1, a2 = kA2 / kNa * g2;
    const double b0 = 1 / kNb * g0, b1 = kB / kNb * g1, b2 = kB2 / kNb * g2;
    o[0][l] = 1 / kN0 * g0;
    o[o_step][l] = (a0 + a1) + a2;
    o[2 * o_step][l] = (a0 - a1) + a2;
    o[3 * o_step][l] = (b0 + b1) + b2;
    o[4 * o_step][l] = (b0 - b1) + b2;
    o[5 * o_step][l] = g2;
  }
}

}  // namespace

void winograd_weights(const WinogradWeightArguments& a) {
  for (int k = 0; k < a.count; ++k) {
    for (int lane = 0; lane < a.channels; lane += kLanes) {
      const float* in = a.input + static_cast<std::ptrdiff_t>(k) * kWinogradKernel * a.channels + lane;
      float* out = a.output + static_cast<std::ptrdiff_t>(k) * a.channels + lane;
      double g[kWinogradKernel][kLanes], rows[kIn * 3][kLanes], result[kIn][kLanes];
      for (int i = 0; i < kWinogradKernel; ++i) {
        for (int l = 0; l < kLanes; ++l) g[i][l] = static_cast<double>(in[i * a.channels + l]);
      }
      for (int v = 0; v < 3; ++v) transform(g + v, 3, rows + v, 3);
      for (int i = 0; i < kIn; ++i) {
        transform(rows + 3 * i, 1, result, 1);
        for (int j = 0; j < kIn; ++j, out += a.position_stride) {
          for (int l = 0; l < kLanes; ++l) out[l] = static_cast<float>(result[j][l]);
        }
      }
    }
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
