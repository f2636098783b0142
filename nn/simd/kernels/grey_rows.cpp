// Sobel's slopes summed over a row, and a row of colour made grey. A register of grey's part has 4 pixels in
// each 128 bits; the 256-bit one holds the pixels from 0 on and those from 16 on side by side, so that
// packing leaves them in order.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kBlue = 3735, kGreen = 19235, kRed = 9798, kHalf = 1 << 14;  // in 32768ths

// Byte numbers of four pixels: blue and green as 16-bit numbers, and red with a 0 beside it.
__m128i blue_green_bytes() { return _mm_setr_epi8(0, -1, 1, -1, 3, -1, 4, -1, 6, -1, 7, -1, 9, -1, 10, -1); }
__m128i red_bytes() { return _mm_setr_epi8(2, -1, -1, -1, 5, -1, -1, -1, 8, -1, -1, -1, 11, -1, -1, -1); }

__attribute__((always_inline)) inline __m128i load(const std::uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}

#if defined(__AVX2__)
using Wide = __m256i;
constexpr int kPixels = 32;

Wide both(__m128i half) { return _mm256_broadcastsi128_si256(half); }
Wide pack32(Wide a, Wide b) { return _mm256_packs_epi32(a, b); }
Wide pack16(Wide a, Wide b) { return _mm256_packus_epi16(a, b); }
void store(std::uint8_t* to, Wide a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), a); }
__attribute__((always_inline)) inline Wide greys(const std::uint8_t* p) {
  const Wide bytes = _mm256_inserti128_si256(_mm256_castsi128_si256(load(p)), load(p + 48), 1);
  const Wide blue_green = _mm256_shuffle_epi8(bytes, both(blue_green_bytes()));
  const Wide red = _mm256_shuffle_epi8(bytes, both(red_bytes()));
  const Wide sum = _mm256_add_epi32(_mm256_madd_epi16(blue_green, _mm256_set1_epi32(kGreen << 16 | kBlue)),
                                    _mm256_madd_epi16(red, _mm256_set1_epi32(kRed)));
  return _mm256_srli_epi32(_mm256_add_epi32(sum, _mm256_set1_epi32(kHalf)), 15);
}
#else
using Wide = __m128i;
constexpr int kPixels = 16;

Wide pack32(Wide a, Wide b) { return _mm_packs_epi32(a, b); }
Wide pack16(Wide a, Wide b) { return _mm_packus_epi16(a, b); }
void store(std::uint8_t* to, Wide a) { _mm_storeu_si128(reinterpret_cast<__m128i*>(to), a); }
__attribute__((always_inline)) inline Wide greys(const std::uint8_t* p) {
  const Wide bytes = load(p);
  const Wide blue_green = _mm_shuffle_epi8(bytes, blue_green_bytes());
  const Wide red = _mm_shuffle_epi8(bytes, red_bytes());
  const Wide sum = _mm_add_epi32(_mm_madd_epi16(blue_green, _mm_set1_epi32(kGreen << 16 | kBlue)),
                                 _mm_madd_epi16(red, _mm_set1_epi32(kRed)));
  return _mm_srli_epi32(_mm_add_epi32(sum, _mm_set1_epi32(kHalf)), 15);
}
#endif

}  // namespace

std::uint64_t slope_energy(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                           int count, int least) {
  constexpr int kChunk = 1024;  // whose sum, at most 1024 * 2 * 1020^2, fits into 32 bits
  std::uint64_t total = 0;
  for (int begin = 0; begin < count; begin += kChunk) {
    const int end = count - begin < kChunk ? count : begin + kChunk;
    std::uint32_t sum = 0;
    for (int i = begin; i < end; ++i) {
      const auto gx = static_cast<std::int16_t>(
          above[i + 1] - above[i - 1] + 2 * (here[i + 1] - here[i - 1]) + below[i + 1] - below[i - 1]);
      const auto gy = static_cast<std::int16_t>(below[i - 1] + 2 * below[i] + below[i + 1] - above[i - 1] -
                                                2 * above[i] - above[i + 1]);
      const int q = gx * gx + gy * gy;
      sum += q > least ? static_cast<std::uint32_t>(q) : 0U;
    }
    total += sum;
  }
  return total;
}

void grey_row(const std::uint8_t* bgr, int count, std::uint8_t* grey) {
  int i = 0;
  // 16 bytes are read where 12 are used.
  for (; i + kPixels + 2 <= count; i += kPixels) {
    const std::uint8_t* p = bgr + 3 * i;
    const Wide first = pack32(greys(p), greys(p + 12)), second = pack32(greys(p + 24), greys(p + 36));
    store(grey + i, pack16(first, second));
  }
  for (; i < count; ++i) {
    const std::uint8_t* p = bgr + 3 * i;
    grey[i] = static_cast<std::uint8_t>((kBlue * p[0] + kGreen * p[1] + kRed * p[2] + kHalf) >> 15);
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
