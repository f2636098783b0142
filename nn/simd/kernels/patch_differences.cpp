// Sums of absolute differences of small patches, a row of 16-bit numbers at a time: those of a row's 16 that
// are none of the patch's get the weight 0.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kRead = 16;  // bytes of a row

__attribute__((always_inline)) inline __m128i load(const std::uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}

#if defined(__AVX2__)
struct Row {
  __m256i pixels;

  explicit Row(const std::uint8_t* p) : pixels(_mm256_cvtepu8_epi16(load(p))) {}
};
using Sums = __m256i;
Sums nothing() { return _mm256_setzero_si256(); }
__attribute__((always_inline)) inline Sums add_difference(Sums sums, const Row& a, const Row& b,
                                                          short offset) {
  const __m256i weights = _mm256_setr_epi16(1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0);
  const __m256i d = _mm256_sub_epi16(_mm256_sub_epi16(a.pixels, b.pixels), _mm256_set1_epi16(offset));
  return _mm256_add_epi32(sums, _mm256_madd_epi16(_mm256_abs_epi16(d), weights));
}
__m128i folded(Sums sums) {
  return _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
}
#else
struct Row {
  __m128i low, high;

  explicit Row(const std::uint8_t* p) {
    const __m128i bytes = load(p);
    low = _mm_cvtepu8_epi16(bytes);
    high = _mm_unpackhi_epi8(bytes, _mm_setzero_si128());
  }
};
using Sums = __m128i;
Sums nothing() { return _mm_setzero_si128(); }
__attribute__((always_inline)) inline Sums add_difference(Sums sums, const Row& a, const Row& b,
                                                          short offset) {
  const __m128i o = _mm_set1_epi16(offset), ones = _mm_set1_epi16(1);
  const __m128i low = _mm_sub_epi16(_mm_sub_epi16(a.low, b.low), o),
                high = _mm_sub_epi16(_mm_sub_epi16(a.high, b.high), o);
  sums = _mm_add_epi32(sums, _mm_madd_epi16(_mm_abs_epi16(low), ones));
  return _mm_add_epi32(sums, _mm_madd_epi16(_mm_abs_epi16(high), _mm_setr_epi16(1, 1, 1, 0, 0, 0, 0, 0)));
}
__m128i folded(Sums sums) { return sums; }
#endif

int total(Sums sums) {
  const __m128i four = folded(sums), two = _mm_hadd_epi32(four, four);
  return _mm_cvtsi128_si32(_mm_hadd_epi32(two, two));
}

}  // namespace

void patch_differences(const std::uint8_t* left, std::ptrdiff_t left_pitch, const std::uint8_t* right,
                       std::ptrdiff_t right_pitch, int* sums) {
  static_assert(kDifferenceSide <= kRead && kDifferenceSide == 11, "the weights are those of 11 pixels");
  short offsets[kDifferenceSide];
  Sums of_shift[kDifferenceSide];
  for (int s = 0; s < kDifferenceSide; ++s) {
    offsets[s] = static_cast<short>(left[0] - right[s - kDifferenceReach]);
    of_shift[s] = nothing();
  }
  left -= kDifferenceReach * (left_pitch + 1);
  right -= kDifferenceReach * (right_pitch + 2);  // of the first place
  for (int y = 0; y < kDifferenceSide; ++y, left += left_pitch, right += right_pitch) {
    const Row row(left);
    for (int s = 0; s < kDifferenceSide; ++s)
      of_shift[s] = add_difference(of_shift[s], row, Row(right + s), offsets[s]);
  }
  for (int s = 0; s < kDifferenceSide; ++s) sums[s] = total(of_shift[s]);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
