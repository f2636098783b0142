// The register tile of bf16 and of 8-bit numbers, and the conversions to them. For processors with AVX-512's
// BF16 and VNNI extensions; this file alone is compiled for them.

#include "nn/simd/low_precision.h"

#include <immintrin.h>

#include <cstring>

#include "nn/simd/kernels/register_tile.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

// Neighbouring channels as one 32-bit number in every lane: 2 of bf16, 4 of 8 bits. Read as if an f32, for
// which compilers choose the instruction that broadcasts from memory; as a whole number it would go the long
// way by a general register.
template <class Element>
__attribute__((always_inline)) inline __m512i broadcast_32_bits(const Element* x) {
  using Group [[gnu::may_alias]] = float;
  return _mm512_castps_si512(_mm512_set1_ps(*reinterpret_cast<const Group*>(x)));
}

// VDPBF16PS: two products of bf16 a lane, summed in f32.
struct Bf16 {
  using Element = std::uint16_t;
  using Sum = Vector;
  using Group = __m512i;
  using Weights = __m512i;
  static constexpr int kGroup = 2;
  static constexpr bool kPairs = false, kOwnSteps = false;

  __attribute__((always_inline)) static Vector zero() { return Vector(0.0F); }
  __attribute__((always_inline)) static __m512i load(const Element* w) { return _mm512_load_si512(w); }
  __attribute__((always_inline)) static __m512i broadcast(const Element* x) { return broadcast_32_bits(x); }
  __attribute__((always_inline)) static Vector multiply(__m512i x, __m512i w, const Vector& sum) {
    return _mm512_dpbf16_ps(sum, (__m512bh)x, (__m512bh)w);
  }
  __attribute__((always_inline)) static Vector finish(const Vector& sum, const TileArguments&, int) {
    return sum;
  }
};

// VPDPBUSD: four products of an unsigned input and a signed weight a lane, summed in 32-bit whole numbers.
struct Int8 {
  using Element = std::uint8_t;  // of inputs; the weights are signed, of the same size
  using Sum = __m512i;
  using Group = __m512i;
  using Weights = __m512i;
  static constexpr int kGroup = 4;
  static constexpr bool kPairs = false, kOwnSteps = false;

  __attribute__((always_inline)) static __m512i zero() { return _mm512_setzero_si512(); }
  __attribute__((always_inline)) static __m512i load(const Element* w) { return _mm512_load_si512(w); }
  __attribute__((always_inline)) static __m512i broadcast(const Element* x) { return broadcast_32_bits(x); }
  __attribute__((always_inline)) static __m512i multiply(__m512i x, __m512i w, __m512i sum) {
    return _mm512_dpbusd_epi32(sum, x, w);
  }
  __attribute__((always_inline)) static Vector finish(__m512i sum, const TileArguments& a, int v) {
    return Vector(_mm512_cvtepi32_ps(sum)) * Vector::load_unaligned(a.scale + v * kLanes);
  }
};

// `count` is a multiple of 16 in both.
void to_bf16(const float* values, std::ptrdiff_t count, const Quantisation&, void* out) {
  auto* to = static_cast<std::uint16_t*>(out);
  for (std::ptrdiff_t i = 0; i < count; i += kLanes) {
    const __m256bh rounded = _mm512_cvtneps_pbh(_mm512_loadu_ps(values + i));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + i), (__m256i)rounded);
  }
}

void to_int8(const float* values, std::ptrdiff_t count, const Quantisation& quantisation, void* out) {
  auto* to = static_cast<std::uint8_t*>(out);
  const __m512 factor = _mm512_set1_ps(1.0F / quantisation.scale);
  const __m512 zero = _mm512_set1_ps(static_cast<float>(quantisation.zero));
  for (std::ptrdiff_t i = 0; i < count; i += kLanes) {
    // Rounded to the nearest whole number; the maximum takes NaN to 0 and keeps the number from being taken
    // for a large unsigned one.
    const __m512 scaled =
        _mm512_max_ps(_mm512_fmadd_ps(_mm512_loadu_ps(values + i), factor, zero), _mm512_setzero_ps());
    const __m128i bytes = _mm512_cvtusepi32_epi8(_mm512_cvtps_epu32(scaled));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i), bytes);
  }
}

}  // namespace

extern const LowPrecisionKernels kBf16Kernels, kInt8Kernels;
constexpr LowPrecisionKernels kBf16Kernels = {register_tile<Bf16>(), to_bf16};
constexpr LowPrecisionKernels kInt8Kernels = {register_tile<Int8>(), to_int8};

}  // namespace penumbra::nn::PENUMBRA_ISA
