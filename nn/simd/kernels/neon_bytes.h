// 8-bit numbers on NEON, whose products take two signed ones: inputs q in 0..255 are multiplied as q - 128,
// and the layer's zero is 128 less (TileKernels::input_offset).
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "nn/simd/kernels/vector.h"
#include "nn/simd/low_precision.h"

namespace penumbra::nn::PENUMBRA_ISA {

constexpr int kInputOffset = 128;

// `count` is a multiple of 16.
static inline void to_int8(const float* values, std::ptrdiff_t count, const Quantisation& quantisation,
                           void* out) {
  auto* to = static_cast<std::uint8_t*>(out);
  const float32x4_t factor = vdupq_n_f32(1.0F / quantisation.scale);
  const float32x4_t zero = vdupq_n_f32(static_cast<float>(quantisation.zero));
  // The nearest whole number, 0 for NaN.
  const auto four = [&](const float* from) __attribute__((always_inline)) {
    return vcvtnq_u32_f32(vfmaq_f32(zero, vld1q_f32(from), factor));
  };
  const auto eight = [&](const float* from) __attribute__((always_inline)) {
    return vqmovn_high_u32(vqmovn_u32(four(from)), four(from + 4));
  };
  for (std::ptrdiff_t i = 0; i < count; i += 16) {
    const uint8x16_t bytes = vqmovn_high_u16(vqmovn_u16(eight(values + i)), eight(values + i + 8));
    vst1q_u8(to + i, veorq_u8(bytes, vdupq_n_u8(kInputOffset)));
  }
}

// The sums as numbers.
__attribute__((always_inline)) static inline Vector scaled(int32x4_t sum, const TileArguments& a, int v) {
  return Vector(vcvtq_f32_s32(sum)) * Vector::load_unaligned(a.scale + v * kLanes);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
