// The moments that give a corner its direction: products of bytes with small weights, summed in pairs to 16
// bits and in fours to 32.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

void disc_moments(const std::uint8_t* centre, std::ptrdiff_t pitch, const DiscWeights& weights, int* m10,
                  int* m01) {
  const std::uint8_t* row = centre - kDiscRadius * pitch - kDiscRadius;
#if defined(__AVX2__)
  const auto load = [](const void* p) { return _mm256_loadu_si256(static_cast<const __m256i*>(p)); };
  __m256i x = _mm256_setzero_si256(), y = x;
  for (int j = 0; j < kDiscRows; ++j, row += pitch) {
    const __m256i bytes = load(row);
    x = _mm256_add_epi32(
        x, _mm256_madd_epi16(_mm256_maddubs_epi16(bytes, load(weights.column[j])), _mm256_set1_epi16(1)));
    y = _mm256_add_epi32(y, _mm256_madd_epi16(_mm256_maddubs_epi16(bytes, load(weights.one[j])),
                                              _mm256_set1_epi16(static_cast<short>(j - kDiscRadius))));
  }
  const __m128i x4 = _mm_add_epi32(_mm256_castsi256_si128(x), _mm256_extracti128_si256(x, 1));
  const __m128i y4 = _mm_add_epi32(_mm256_castsi256_si128(y), _mm256_extracti128_si256(y, 1));
#else
  const auto load = [](const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); };
  __m128i x4 = _mm_setzero_si128(), y4 = x4;
  for (int j = 0; j < kDiscRows; ++j, row += pitch) {
    const __m128i line = _mm_set1_epi16(static_cast<short>(j - kDiscRadius));
    for (int half = 0; half < kDiscStride; half += 16) {
      const __m128i bytes = load(row + half);
      x4 = _mm_add_epi32(
          x4, _mm_madd_epi16(_mm_maddubs_epi16(bytes, load(weights.column[j] + half)), _mm_set1_epi16(1)));
      y4 = _mm_add_epi32(y4, _mm_madd_epi16(_mm_maddubs_epi16(bytes, load(weights.one[j] + half)), line));
    }
  }
#endif
  // Both sums in one: x and y side by side.
  const __m128i pairs = _mm_hadd_epi32(x4, y4), sums = _mm_hadd_epi32(pairs, pairs);
  *m10 = _mm_cvtsi128_si32(sums);
  *m01 = _mm_extract_epi32(sums, 1);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
