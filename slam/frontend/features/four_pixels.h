// Four grey values side by side as numbers: what the arithmetic of patches goes on. An instruction for each
// step, on every processor that the program runs on; the sums are those of one pixel after the other.
#pragma once

#if defined(__x86_64__)
#include <smmintrin.h>
#endif

#include <cstdint>
#include <cstring>

namespace penumbra::slam {

using Four [[gnu::vector_size(16)]] = float;

inline Four load_four(const std::uint8_t* pixels) {
#if defined(__x86_64__)
  std::int32_t bytes;
  std::memcpy(&bytes, pixels, sizeof bytes);
  return _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(bytes)));
#else
  using FourBytes [[gnu::vector_size(4)]] = std::uint8_t;
  FourBytes bytes;
  std::memcpy(&bytes, pixels, sizeof bytes);
  return __builtin_convertvector(bytes, Four);
#endif
}
inline Four load_four(const float* values) {
  Four four;
  std::memcpy(&four, values, sizeof four);
  return four;
}
inline void store_four(float* to, const Four& values) { std::memcpy(to, &values, sizeof values); }

// A row of `width` in fours, the last of which begins earlier where they do not fill the row: 11 is 0, 4, 7.
template <int width, typename Work>
void for_each_four(Work&& work) {
  for (int i = 0; i + 4 <= width; i += 4) work(i);
  if constexpr (width % 4 != 0) work(width - 4);
}

}  // namespace penumbra::slam
