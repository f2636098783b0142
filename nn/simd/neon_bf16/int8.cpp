// The register tile of 8-bit numbers for ARM processors with I8MM. SMMLA: 8 products of signed bytes for each
// of 2 x 2 sums, in 32-bit whole numbers.

#include "nn/simd/kernels/neon_bytes.h"
#include "nn/simd/kernels/neon_steps.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Int8 : NumberOfPairs<Int8> {
  using Element = std::int8_t;
  using Sum = int32x4_t;
  static constexpr int kGroup = 4;

  __attribute__((always_inline)) static int32x4_t zero() { return vdupq_n_s32(0); }
  __attribute__((always_inline)) static int32x4_t multiply(uint64x2_t x, uint64x2_t w, int32x4_t sum) {
    return vmmlaq_s32(sum, vreinterpretq_s8_u64(x), vreinterpretq_s8_u64(w));
  }
  __attribute__((always_inline)) static Vector finish(int32x4_t sum, const TileArguments& a, int v) {
    return scaled(sum, a, v);
  }
};

}  // namespace

extern const LowPrecisionKernels kInt8Kernels;
constexpr LowPrecisionKernels kInt8Kernels = {register_tile<Int8>(kInputOffset), to_int8};

}  // namespace penumbra::nn::PENUMBRA_ISA
