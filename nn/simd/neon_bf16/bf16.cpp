// The register tile of bf16 for ARM processors with BF16. BFMMLA: 4 products of bf16 for each of 2 x 2 sums,
// in f32. Its sums are rounded to odd and denormal numbers count as 0, unless the processor does better
// (FEAT_EBF16 and asked for it).

#include "nn/simd/kernels/neon_steps.h"
#include "nn/simd/low_precision.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Bf16 : NumberOfPairs<Bf16> {
  using Element = std::uint16_t;
  using Sum = float32x4_t;
  static constexpr int kGroup = 2;

  __attribute__((always_inline)) static float32x4_t zero() { return vdupq_n_f32(0.0F); }
  __attribute__((always_inline)) static float32x4_t multiply(uint64x2_t x, uint64x2_t w, float32x4_t sum) {
    return vbfmmlaq_f32(sum, vreinterpretq_bf16_u64(x), vreinterpretq_bf16_u64(w));
  }
  __attribute__((always_inline)) static Vector finish(float32x4_t sum, const TileArguments&, int) {
    return Vector(sum);
  }
};

// `count` is a multiple of 16.
void to_bf16(const float* values, std::ptrdiff_t count, const Quantisation&, void* out) {
  auto* to = static_cast<std::uint16_t*>(out);
  for (std::ptrdiff_t i = 0; i < count; i += 8) {
    const bfloat16x8_t low = vcvtq_low_bf16_f32(vld1q_f32(values + i));
    vst1q_u16(to + i, vreinterpretq_u16_bf16(vcvtq_high_bf16_f32(low, vld1q_f32(values + i + 4))));
  }
}

}  // namespace

extern const LowPrecisionKernels kBf16Kernels;
constexpr LowPrecisionKernels kBf16Kernels = {register_tile<Bf16>(), to_bf16};

}  // namespace penumbra::nn::PENUMBRA_ISA
