// Sixteen numbers of a line as f32 in registers, and back. Compilers turn the operations on Floats into
// vector instructions of any width; the conversions that they do not are spelled out for AVX-512.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "nn/simd/tile_unit.h"

namespace penumbra::nn::PENUMBRA_ISA {

#define PENUMBRA_INLINE __attribute__((always_inline)) static inline

constexpr int kSixteen = 16;
using Floats = float __attribute__((vector_size(64)));
using Words = std::uint32_t __attribute__((vector_size(64)));

// Out by reference: as a result it would go by the stack where registers are narrower.
PENUMBRA_INLINE void fill(Floats& x, float value) { x = value - Floats{}; }
PENUMBRA_INLINE void load_f32(const void* from, Floats& x) { std::memcpy(&x, from, sizeof(x)); }
PENUMBRA_INLINE void store_f32(const Floats& x, void* to) { std::memcpy(to, &x, sizeof(x)); }
// c = a b + c in one rounding. Spelled out, and the compiler does not do it by itself in this folder
// (-ffp-contract=off), so that all instruction sets give the same bits.
PENUMBRA_INLINE void multiply_add(const Floats& a, const Floats& b, Floats& c) {
#if defined(__AVX512F__)
  c = (Floats)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
#else
  __m256 x[2], y[2], z[2];
  std::memcpy(x, &a, sizeof(x));
  std::memcpy(y, &b, sizeof(y));
  std::memcpy(z, &c, sizeof(z));
  for (int i = 0; i < 2; ++i) z[i] = _mm256_fmadd_ps(x[i], y[i], z[i]);
  std::memcpy(&c, z, sizeof(z));
#endif
}
PENUMBRA_INLINE void keep_greater(const Floats& other, Floats& x) { x = other > x ? other : x; }

PENUMBRA_INLINE void load_bf16(const void* from, Floats& x) {
#if defined(__AVX512F__)
  const __m512i words = _mm512_cvtepu16_epi32(_mm256_loadu_si256(static_cast<const __m256i*>(from)));
  x = (Floats)_mm512_slli_epi32(words, 16);
#else
  Words words;
  std::uint16_t shorts[kSixteen];
  std::memcpy(shorts, from, sizeof(shorts));
  for (int i = 0; i < kSixteen; ++i) words[i] = std::uint32_t{shorts[i]} << 16;
  x = (Floats)words;
#endif
}

// To the nearest, of two equally near the one whose last bit is 0. No NaN is made an infinity: its upper
// mantissa bit is set first.
PENUMBRA_INLINE void store_bf16(const Floats& x, void* to) {
  const Words bits = (Words)x;
  Words rounded = (bits + 0x7FFFU + ((bits >> 16) & 1U)) >> 16;
  rounded = x == x ? rounded : (bits >> 16 | 0x40U);
#if defined(__AVX512F__)
  _mm256_storeu_si256(static_cast<__m256i*>(to), _mm512_cvtepi32_epi16((__m512i)rounded));
#else
  std::uint16_t shorts[kSixteen];
  for (int i = 0; i < kSixteen; ++i) shorts[i] = static_cast<std::uint16_t>(rounded[i]);
  std::memcpy(to, shorts, sizeof(shorts));
#endif
}

// As whole numbers 0..255 in f32.
PENUMBRA_INLINE void load_bytes(const void* from, Floats& x) {
#if defined(__AVX512F__)
  x = (Floats)_mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128(static_cast<const __m128i*>(from))));
#else
  std::uint8_t bytes[kSixteen];
  std::memcpy(bytes, from, sizeof(bytes));
  for (int i = 0; i < kSixteen; ++i) x[i] = static_cast<float>(bytes[i]);
#endif
}

// Rounded to the nearest of 0..255, ties to even; NaN becomes 0.
PENUMBRA_INLINE void store_bytes(const Floats& scaled, void* to) {
  constexpr float kRound = 1.5F * (1 << 23);  // above it, neighbouring floats are 1 apart
  Floats x = scaled > 0.0F ? scaled : Floats{};
  x = x < 255.0F ? x : 255.0F - Floats{};
  const Words whole = (Words)(x + kRound);
#if defined(__AVX512F__)
  _mm_storeu_si128(static_cast<__m128i*>(to), _mm512_cvtepi32_epi8((__m512i)whole));
#else
  std::uint8_t bytes[kSixteen];
  for (int i = 0; i < kSixteen; ++i) bytes[i] = static_cast<std::uint8_t>(whole[i]);
  std::memcpy(to, bytes, sizeof(bytes));
#endif
}

// One kind of numbers: reads and writes sixteen values.
template <Precision P>
struct Stored {
  static constexpr int kBytes = kSixteen * element_size(P);  // of sixteen values

  __attribute__((always_inline)) explicit Stored(const Numbers& numbers) {
    if constexpr (P == Precision::int8) {
      fill(scale_, numbers.quantisation.scale);
      fill(inverse_, 1.0F / numbers.quantisation.scale);
      fill(zero_, static_cast<float>(numbers.quantisation.zero));
    }
  }
  __attribute__((always_inline)) void load(const void* from, Floats& x) const {
    if constexpr (P == Precision::f32) load_f32(from, x);
    if constexpr (P == Precision::bf16) load_bf16(from, x);
    if constexpr (P == Precision::int8) {
      load_bytes(from, x);
      x = (x - zero_) * scale_;
    }
  }
  __attribute__((always_inline)) void store(const Floats& x, void* to) const {
    if constexpr (P == Precision::f32) store_f32(x, to);
    if constexpr (P == Precision::bf16) store_bf16(x, to);
    if constexpr (P == Precision::int8) store_bytes(x * inverse_ + zero_, to);
  }

 private:
  struct Nothing {};
  using Constant = std::conditional_t<P == Precision::int8, Floats, Nothing>;
  [[no_unique_address]] Constant scale_, inverse_, zero_;
};

// Calls function(Stored<P>) with the kind that `numbers` names.
template <class Function>
__attribute__((always_inline)) static inline void with_stored(const Numbers& numbers, Function function) {
  switch (numbers.precision) {
    case Precision::f32:
      return function(Stored<Precision::f32>(numbers));
    case Precision::bf16:
      return function(Stored<Precision::bf16>(numbers));
    case Precision::int8:
      return function(Stored<Precision::int8>(numbers));
  }
}

// Where sixteen channels from `channel`, a multiple of 16, on lie, counted from their pixel's first line.
PENUMBRA_INLINE std::ptrdiff_t channel_offset(const LineLayout& layout, int channel) {
  const int line = line_channels(layout.numbers.precision);
  return channel / line * layout.block_stride +
         static_cast<std::ptrdiff_t>(channel % line) * element_size(layout.numbers.precision);
}

#undef PENUMBRA_INLINE

}  // namespace penumbra::nn::PENUMBRA_ISA
