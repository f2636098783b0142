// The two halves of a bilinear resize of bytes: a row stretched, and two stretched rows mixed.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

// 4 pixels: (left * w0 + right * w1) / 16 as 32-bit numbers.
__attribute__((always_inline)) inline __m128i mix(__m128i bytes, const std::uint8_t* which,
                                                  const std::int16_t* weights) {
  const __m128i pairs = _mm_shuffle_epi8(bytes, _mm_loadu_si128(reinterpret_cast<const __m128i*>(which)));
  const __m128i w = _mm_loadu_si128(reinterpret_cast<const __m128i*>(weights));
  return _mm_srli_epi32(_mm_madd_epi16(pairs, w), 4);
}

}  // namespace

void resize_row(const ResizeRowArguments& a) {
  std::int16_t* out = a.out;
  const std::int16_t* weights = a.weights;
  for (int b = 0; b < a.block_count; ++b, out += 8, weights += 16) {
    const ResizeBlock& block = a.blocks[b];
    const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(a.row + block.begin));
    const __m128i low = mix(bytes, block.low_bytes, weights),
                  high = mix(bytes, block.high_bytes, weights + 8);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out), _mm_packs_epi32(low, high));
  }
  for (int x = 8 * a.block_count; x < a.width; ++x) {
    const std::uint8_t* left = a.row + a.columns[x];
    const int sum = left[0] * a.weights[2 * x] + left[a.right] * a.weights[2 * x + 1];
    a.out[x] = static_cast<std::int16_t>(sum >> 4);
  }
}

void resize_mix(const std::int16_t* upper, const std::int16_t* lower, int w0, int w1, int width,
                std::uint8_t* out) {
  const auto share0 = static_cast<std::int16_t>(w0), share1 = static_cast<std::int16_t>(w1);
  std::uint8_t* __restrict to = out;
  for (int x = 0; x < width; ++x) {
    const auto a = static_cast<std::int16_t>((upper[x] * share0) >> 16);
    const auto b = static_cast<std::int16_t>((lower[x] * share1) >> 16);
    to[x] = static_cast<std::uint8_t>(static_cast<std::int16_t>(a + b + 2) >> 2);
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
