// A step of the register tile on NEON: 16 bytes of every pixel, 4 channels of f32, 8 of bf16 or 16 of 8 bits,
// by the weights of these channels.
//
// NEON's multiply-add takes one lane of a register as the factor of all lanes of another. So a pixel's
// numbers are not broadcast, which would be a load and a duplication for each, but loaded four groups at a
// time; the loads of 8 pixels x 8 outputs are 8 + 8 for 64 multiply-adds, and 16 sums, 8 pixels and 2 weights
// are 26 of the 32 registers.
//
// BFMMLA and SMMLA multiply two rows of 8 bytes (4 channels of bf16, 8 of 8 bits of two pixels) by two others
// (of two outputs) to 2 x 2 sums: a register of sums is
//
//   [pixel 0, output 0]  [pixel 0, output 1]  [pixel 1, output 0]  [pixel 1, output 1]
//
// and every number that is loaded is used twice by one instruction.
// Source: Arm Architecture Reference Manual for A-profile architecture, C7.2.
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>
#include <utility>

#include "nn/simd/kernels/register_tile.h"

namespace penumbra::nn::PENUMBRA_ISA {

#define PENUMBRA_INLINE __attribute__((always_inline)) static inline

// Number has  load_pixel(x),  load(w)  and  multiply<g>(pixel, weights, sum): sum + group g of pixel *
// weights.
template <class Number, int g, int P, int V, class Pixel, class Sum>
PENUMBRA_INLINE void add_group(const Pixel (&pixels)[P], const typename Number::Element* weights,
                               Sum (&sum)[P][V]) {
#pragma GCC unroll 2
  for (int v = 0; v < V; ++v) {
    const auto w = Number::load(weights + (g * V + v) * Number::kGroup * kLanes);
#pragma GCC unroll 8
    for (int p = 0; p < P; ++p) sum[p][v] = Number::template multiply<g>(pixels[p], w, sum[p][v]);
  }
}

template <class Number, int P, int V, class Sum>
PENUMBRA_INLINE void step_by_lanes(const typename Number::Element* x, std::ptrdiff_t stride,
                                   const typename Number::Element* weights, Sum (&sum)[P][V]) {
  decltype(Number::load_pixel(x)) pixels[P];
#pragma GCC unroll 8
  for (int p = 0; p < P; ++p) pixels[p] = Number::load_pixel(x + p * stride);
  add_group<Number, 0>(pixels, weights, sum);
  add_group<Number, 1>(pixels, weights, sum);
  add_group<Number, 2>(pixels, weights, sum);
  add_group<Number, 3>(pixels, weights, sum);
}

// Number has  multiply(pixels, weights, sum)  of 16 bytes each, in any type of NEON's. Where P is odd the
// last pixel is its own neighbour. sum[2 i + j][v] is of pixels 2 i and 2 i + 1, outputs 4 v + 2 j and the
// next.
template <class Number, int P, int V, int R, class Sum>
PENUMBRA_INLINE void step_by_pairs(const typename Number::Element* x, std::ptrdiff_t stride,
                                   const typename Number::Element* weights, Sum (&sum)[R][V]) {
  static_assert(R == (P + 1) / 2 * 2);
  const auto load = [](const void* from) __attribute__((always_inline)) {
    return vreinterpretq_u64_u8(vld1q_u8(static_cast<const std::uint8_t*>(from)));
  };
  uint64x2_t pairs[2][R / 2];  // of both halves of the 16 bytes
#pragma GCC unroll 4
  for (int i = 0; i < R / 2; ++i) {
    const uint64x2_t first = load(x + 2 * i * stride);
    const uint64x2_t second = 2 * i + 1 < P ? load(x + (2 * i + 1) * stride) : first;
    pairs[0][i] = vzip1q_u64(first, second);
    pairs[1][i] = vzip2q_u64(first, second);
  }
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(weights);
#pragma GCC unroll 2
  for (int half = 0; half < 2; ++half) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) {
#pragma GCC unroll 2
      for (int j = 0; j < 2; ++j) {
        const uint64x2_t w = load(bytes + 16 * ((half * V + v) * 2 + j));
#pragma GCC unroll 4
        for (int i = 0; i < R / 2; ++i) {
          sum[2 * i + j][v] = Number::multiply(pairs[half][i], w, sum[2 * i + j][v]);
        }
      }
    }
  }
}

// From sums of 2 x 2 to one pixel's in each register.
PENUMBRA_INLINE void separate_pair(float32x4_t& first, float32x4_t& second) {
  const float64x2_t a = vreinterpretq_f64_f32(first), b = vreinterpretq_f64_f32(second);
  first = vreinterpretq_f32_f64(vzip1q_f64(a, b));
  second = vreinterpretq_f32_f64(vzip2q_f64(a, b));
}
PENUMBRA_INLINE void separate_pair(int32x4_t& first, int32x4_t& second) {
  const int64x2_t a = vreinterpretq_s64_s32(first), b = vreinterpretq_s64_s32(second);
  first = vreinterpretq_s32_s64(vzip1q_s64(a, b));
  second = vreinterpretq_s32_s64(vzip2q_s64(a, b));
}
template <class Sum, int R, int V>
PENUMBRA_INLINE void separate_pairs(Sum (&sum)[R][V]) {
#pragma GCC unroll 4
  for (int i = 0; i < R; i += 2) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) separate_pair(sum[i][v], sum[i + 1][v]);
  }
}

// What Numbers have of the register tile (register_tile.h) beside what they multiply by: by lanes of one
// pixel, or by pairs of pixels.
template <class Number>
struct NumberOfLanes {
  static constexpr bool kPairs = false, kOwnSteps = true;
  template <int P, int V, class Element, class Sum>
  PENUMBRA_INLINE void step(const Element* x, std::ptrdiff_t stride, const Element* weights,
                            Sum (&sum)[P][V]) {
    step_by_lanes<Number>(x, stride, weights, sum);
  }
};
template <class Number>
struct NumberOfPairs {
  static constexpr bool kPairs = true, kOwnSteps = true;
  template <int P, int V, int R, class Element, class Sum>
  PENUMBRA_INLINE void step(const Element* x, std::ptrdiff_t stride, const Element* weights,
                            Sum (&sum)[R][V]) {
    step_by_pairs<Number, P>(x, stride, weights, sum);
  }
  template <int R, int V, class Sum>
  PENUMBRA_INLINE void separate(Sum (&sum)[R][V]) {
    separate_pairs(sum);
  }
};

#undef PENUMBRA_INLINE

}  // namespace penumbra::nn::PENUMBRA_ISA
