// The register tile of 8-bit numbers for ARM processors with SDOT: four products of signed bytes a lane,
// summed in 32-bit whole numbers.

#include "nn/simd/kernels/neon_bytes.h"
#include "nn/simd/kernels/neon_steps.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Int8 : NumberOfLanes<Int8> {
  using Element = std::int8_t;
  using Sum = int32x4_t;
  static constexpr int kGroup = 4;

  __attribute__((always_inline)) static int32x4_t zero() { return vdupq_n_s32(0); }
  __attribute__((always_inline)) static int8x16_t load(const Element* w) { return vld1q_s8(w); }
  __attribute__((always_inline)) static int8x16_t load_pixel(const Element* x) { return vld1q_s8(x); }
  template <int group>
  __attribute__((always_inline)) static int32x4_t multiply(int8x16_t x, int8x16_t w, int32x4_t sum) {
    return vdotq_laneq_s32(sum, w, x, group);
  }
  __attribute__((always_inline)) static Vector finish(int32x4_t sum, const TileArguments& a, int v) {
    return scaled(sum, a, v);
  }
};

}  // namespace

extern const LowPrecisionKernels kInt8Kernels;
constexpr LowPrecisionKernels kInt8Kernels = {register_tile<Int8>(kInputOffset), to_int8};

}  // namespace penumbra::nn::PENUMBRA_ISA
