// A row of a remap. The four pixels of a sample are collected into one word, one after the other; the rest is
// arithmetic on rows of words: two 16-bit sums lie side by side in a word, and neither reaches the other.
#include <cstring>

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kChunk = 256;  // samples, whose words stay in the first cache

std::uint32_t two_bytes(const std::uint8_t* p) {
  std::uint16_t both;
  std::memcpy(&both, p, sizeof both);
  return both;
}

__m128i eight_bytes(const std::uint8_t* p) { return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)); }

void remap_grey(const RemapRowArguments& a) {
  std::uint32_t quads[kChunk];
  std::int32_t offsets[kChunk];
  const auto pitch = static_cast<std::int32_t>(a.pitch);
  for (int begin = 0; begin < a.width; begin += kChunk) {
    const int count = a.width - begin < kChunk ? a.width - begin : kChunk;
    const std::int16_t* place = a.places + 2 * begin;
    for (int i = 0; i < count; ++i) offsets[i] = place[2 * i + 1] * pitch + place[2 * i];
    for (int i = 0; i < count; ++i) {
      const std::uint8_t* p = a.image + offsets[i];
      quads[i] = two_bytes(p) | two_bytes(p + a.pitch) << 16;
    }
    const std::uint8_t *dx = a.dx + begin, *dy = a.dy + begin;
    std::uint8_t* __restrict out = a.out + begin;
    for (int i = 0; i < count; ++i) {
      const std::uint32_t right = dx[i], down = dy[i];
      const std::uint32_t rows =
          (quads[i] & 0x00ff00ffU) * (32 - right) + (quads[i] >> 8 & 0x00ff00ffU) * right;
      out[i] = static_cast<std::uint8_t>(((rows & 0xffffU) * (32 - down) + (rows >> 16) * down + 512) >> 10);
    }
  }
}

// One sample in three 32-bit words: blue, green, red.
__attribute__((always_inline)) inline __m128i colour(const std::uint8_t* p, std::ptrdiff_t pitch,
                                                     std::int32_t columns, std::int32_t rows) {
  // Of the upper row's bytes 0..7 and the lower one's -2..5, which lie inside the image, unlike 6 and 7:
  // blue, green, red, each of the four pixels.
  const __m128i order = _mm_setr_epi8(0, 3, 10, 13, 1, 4, 11, 14, 2, 5, 12, 15, -1, -1, -1, -1);
  const __m128i bytes = _mm_unpacklo_epi64(eight_bytes(p), eight_bytes(p + pitch - 2));
  const __m128i mixed = _mm_maddubs_epi16(_mm_shuffle_epi8(bytes, order), _mm_set1_epi32(columns));
  const __m128i sums = _mm_madd_epi16(mixed, _mm_set1_epi32(rows));
  return _mm_srli_epi32(_mm_add_epi32(sums, _mm_set1_epi32(512)), 10);
}

void remap_colour(const RemapRowArguments& a) {
  std::int32_t columns[kChunk], rows[kChunk], offsets[kChunk];
  const auto pitch = static_cast<std::int32_t>(a.pitch);
  for (int begin = 0; begin < a.width; begin += kChunk) {
    const int count = a.width - begin < kChunk ? a.width - begin : kChunk;
    const std::int16_t* place = a.places + 2 * begin;
    for (int i = 0; i < count; ++i) {
      const std::int32_t right = a.dx[begin + i], down = a.dy[begin + i];
      columns[i] = (right << 8 | (32 - right)) * 0x10001;
      rows[i] = down << 16 | (32 - down);
      offsets[i] = place[2 * i + 1] * pitch + 3 * place[2 * i];
    }
    std::uint8_t* out = a.out + 3 * begin;
    const auto words = [&](int i) { return colour(a.image + offsets[i], a.pitch, columns[i], rows[i]); };
    int i = 0;
    for (; i + 4 <= count; i += 4, out += 12) {
      const __m128i four = _mm_packus_epi16(_mm_packs_epi32(words(i), words(i + 1)),
                                            _mm_packs_epi32(words(i + 2), words(i + 3)));
      const __m128i bytes =
          _mm_shuffle_epi8(four, _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1));
      const std::int64_t eight = _mm_cvtsi128_si64(bytes);
      const int four_more = _mm_extract_epi32(bytes, 2);
      std::memcpy(out, &eight, sizeof eight);
      std::memcpy(out + sizeof eight, &four_more, sizeof four_more);
    }
    for (; i < count; ++i, out += 3) {
      const __m128i one = words(i);
      const int pixel = _mm_cvtsi128_si32(_mm_packus_epi16(_mm_packs_epi32(one, one), one));
      std::memcpy(out, &pixel, 3);
    }
  }
}

}  // namespace

void remap_row(const RemapRowArguments& a) { a.channels == 1 ? remap_grey(a) : remap_colour(a); }

}  // namespace penumbra::nn::PENUMBRA_ISA
