// exp(x) in f32 without a call or a branch, so that a compiler turns a loop over it into vector instructions.
//
//   x = n ln 2 + r,  |r| <= ln 2 / 2,   exp(x) = 2^n exp(r),   exp(r) = a polynomial of degree 6
//
// Relative error below 2e-7 on [-87, 88]; x outside is taken as the nearer end, so nothing overflows; NaN
// stays NaN. Source: the range reduction of Cody and Waite 1980; the coefficients of Cephes' expf (Moshier).
#pragma once

#include <bit>
#include <cstdint>

namespace penumbra::nn {

// Inlined always: a copy of its own would carry one instruction set into files that are for all.
[[gnu::always_inline]] inline float exponential(float x) {
  constexpr float kLowest = -87.0F, kHighest = 88.0F;  // 2^n stays a normal number
  constexpr float kLog2E = 1.44269504F;
  constexpr float kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F;  // n kLn2High is exact
  constexpr float kRound =
      12582912.0F;  // 1.5 * 2^23: adding it leaves the nearest whole number in the low bits
  x = x < kLowest ? kLowest : x;
  x = x > kHighest ? kHighest : x;
  const float shifted = x * kLog2E + kRound;
  const float n = shifted - kRound;
  const float r = (x - n * kLn2High) - n * kLn2Low;
  float p = 1.9875691500e-4F;
  p = p * r + 1.3981999507e-3F;
  p = p * r + 8.3334519073e-3F;
  p = p * r + 4.1665795894e-2F;
  p = p * r + 1.6666665459e-1F;
  p = p * r + 5.0000001201e-1F;
  p = p * r * r + r + 1.0F;
  // The low bits of `shifted` are n; moved into the exponent, 127 more, they are 2^n.
  return p * std::bit_cast<float>((std::bit_cast<std::uint32_t>(shifted) + 127U) << 23);
}

}  // namespace penumbra::nn
