// Conversions between f32 and the two 16-bit floating-point formats.
//
//   f16  (IEEE 754 binary16): 1 sign, 5 exponent, 10 fraction bits        bf16: the upper 16 bits of an f32
//
// To f32 every conversion is exact; from f32 it rounds to nearest, ties to even; NaN stays NaN, overflow
// becomes infinity.
#pragma once

#include <bit>
#include <cstdint>

namespace penumbra::nn {

// Of a finite number.
inline std::uint16_t f32_to_bf16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<std::uint16_t>((bits + 0x7FFFU + ((bits >> 16) & 1U)) >> 16);
}

inline float bf16_to_f32(std::uint16_t bits) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16);
}

// Without a branch, so that loops of it become vector code.
inline float f16_to_f32(std::uint16_t bits) {
  const std::uint32_t sign = (bits & 0x8000U) << 16, magnitude = (bits & 0x7FFFU) << 13;
  // As an f32 of the same bits this is 2^-112 times the number, also where it is subnormal.
  const float number = std::bit_cast<float>(magnitude) * 0x1p112F;
  const std::uint32_t infinite = (bits & 0x7C00U) == 0x7C00U ? 0x7F800000U : 0U;  // and NaN
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(number) | infinite | sign);
}

inline std::uint16_t f32_to_f16(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16) & 0x8000U;
  const std::uint32_t magnitude = bits & 0x7FFFFFFFU;
  if (magnitude > 0x7F800000U) return static_cast<std::uint16_t>(sign | 0x7E00U);   // NaN
  if (magnitude >= 0x477FF000U) return static_cast<std::uint16_t>(sign | 0x7C00U);  // rounds to >= 65536
  if (magnitude < 0x38800000U) {  // below 2^-14: subnormal; adding 0.5 rounds at bit 2^-24 in the f32 adder
    const float shifted = std::bit_cast<float>(magnitude) + 0.5F;
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(shifted) - 0x3F000000U));
  }
  const std::uint32_t odd = (magnitude >> 13) & 1U;
  return static_cast<std::uint16_t>(sign | ((magnitude - 0x38000000U + 0xFFFU + odd) >> 13));
}

}  // namespace penumbra::nn
