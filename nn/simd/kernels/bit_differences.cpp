// The bits in which rows of 256 differ. Where the processor counts them in vectors (AVX-512 VPOPCNTDQ), eight
// rows go together: four registers of two rows each, whose counts are put side by side in 16-bit fields and
// then added across the four words of a row. NEON counts in bytes, and adds up those of a row. Elsewhere a
// word at a time: one instruction since x86-64-v2.
#include "nn/simd/kernels/kernels.h"

#if defined(__AVX512F__)
#include <immintrin.h>
#elif defined(PENUMBRA_NEON)
#include <arm_neon.h>
#endif

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

std::uint16_t row_difference(const std::uint64_t* a, const std::uint64_t* b) {
#if defined(PENUMBRA_NEON)
  const auto counts = [&](int w) {
    return vcntq_u8(vreinterpretq_u8_u64(veorq_u64(vld1q_u64(a + w), vld1q_u64(b + w))));
  };
  return vaddlvq_u8(vaddq_u8(counts(0), counts(2)));
#else
  int sum = 0;
  for (int w = 0; w < kBitRowWords; ++w) sum += __builtin_popcountll(a[w] ^ b[w]);
  return static_cast<std::uint16_t>(sum);
#endif
}

#if defined(__AVX512F__)
// Returns how many rows it has done: all but up to seven.
__attribute__((target("avx512vpopcntdq"))) int by_vectors(const std::uint64_t* one, const std::uint64_t* rows,
                                                          int count, std::uint16_t* differences) {
  const __m512i query = _mm512_broadcast_i64x4(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(one)));
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    __m512i fields =
        _mm512_setzero_si512();  // of each word: the counts of rows 0 (or 1), 2, 4, 6 from the low end
    for (int pair = 3; pair >= 0; --pair) {
      const __m512i bits = _mm512_xor_si512(query, _mm512_loadu_si512(rows + (i + 2 * pair) * kBitRowWords));
      fields = _mm512_or_si512(_mm512_slli_epi64(fields, 16), _mm512_popcnt_epi64(bits));
    }
    fields = _mm512_add_epi16(fields, _mm512_permutex_epi64(fields, 0x4E));
    fields = _mm512_add_epi16(fields, _mm512_permutex_epi64(fields, 0xB1));
    // Even rows in the lower half, odd ones in the upper: interleaved.
    const __m128i even = _mm512_castsi512_si128(fields), odd = _mm512_extracti32x4_epi32(fields, 2);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(differences + i), _mm_unpacklo_epi16(even, odd));
  }
  return i;
}
#endif

}  // namespace

void bit_differences(const std::uint64_t* one, const std::uint64_t* rows, int count,
                     std::uint16_t* differences) {
  int i = 0;
#if defined(__AVX512F__)
  if (__builtin_cpu_supports("avx512vpopcntdq")) i = by_vectors(one, rows, count, differences);
#endif
  for (; i < count; ++i) differences[i] = row_difference(one, rows + i * kBitRowWords);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
