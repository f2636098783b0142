// Lucas-Kanade's window: its values and slopes, and how far another window is off; and rows of a halved
// image. All in whole numbers, so that every instruction set has the same result.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/sse.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kShift = kFlowWeightBits - kFlowValueBits, kRound = 1 << (kShift - 1);

// A register of 16-bit numbers, and what of it is needed here. Pairs lie side by side: unpacking spreads them
// over two registers, packing brings them back in order.
#if defined(__AVX2__)
using Words = __m256i;
constexpr int kLanes = 16;
#define PENUMBRA_WORDS(name) _mm256_##name
Words load_bytes(const std::uint8_t* p) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}
Words load_words(const std::int16_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
void store_words(std::int16_t* p, Words a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a); }
Words zero() { return _mm256_setzero_si256(); }
std::int64_t sum_of(Words a) {
  const __m128i half = _mm_add_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
#else
using Words = __m128i;
constexpr int kLanes = 8;
#define PENUMBRA_WORDS(name) _mm_##name
Words load_bytes(const std::uint8_t* p) {
  return _mm_cvtepu8_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
}
Words load_words(const std::int16_t* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }
void store_words(std::int16_t* p, Words a) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), a); }
Words zero() { return _mm_setzero_si128(); }
std::int64_t sum_of(Words a) {
  const __m128i half = a;
#endif
  const __m128i wide = _mm_add_epi64(_mm_cvtepi32_epi64(half), _mm_cvtepi32_epi64(_mm_srli_si128(half, 8)));
  return _mm_cvtsi128_si64(wide) + _mm_extract_epi64(wide, 1);
}

constexpr int kBlocks = kFlowStride / kLanes;

// Each pixel beside its right neighbour.
struct Pairs {
  Words low, high;
};
Pairs pairs(const std::uint8_t* row) {
  const Words left = load_bytes(row), right = load_bytes(row + 1);
  return {PENUMBRA_WORDS(unpacklo_epi16)(left, right), PENUMBRA_WORDS(unpackhi_epi16)(left, right)};
}

// The weights of the upper two pixels, and of the lower two.
struct Weights {
  Words upper, lower;
  explicit Weights(const int* w)
      : upper(PENUMBRA_WORDS(set1_epi32)(w[1] << 16 | w[0])),
        lower(PENUMBRA_WORDS(set1_epi32)(w[3] << 16 | w[2])) {}
};

Words between(const Pairs& upper, const Pairs& lower, const Weights& w) {
  const Words round = PENUMBRA_WORDS(set1_epi32)(kRound);
  const auto half = [&](Words u, Words l) {
    const Words sum = PENUMBRA_WORDS(add_epi32)(PENUMBRA_WORDS(madd_epi16)(u, w.upper),
                                                PENUMBRA_WORDS(madd_epi16)(l, w.lower));
    return PENUMBRA_WORDS(srai_epi32)(PENUMBRA_WORDS(add_epi32)(sum, round), kShift);
  };
  return PENUMBRA_WORDS(packs_epi32)(half(upper.low, lower.low), half(upper.high, lower.high));
}

}  // namespace

void flow_window(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights, FlowWindow& window) {
  constexpr int kSide = kFlowWindow + 2;
  std::int16_t values[kSide][kFlowStride];
  const Weights w(weights);
  for (int b = 0; b < kBlocks; ++b) {
    const std::uint8_t* row = corner - pitch - 1 + b * kLanes;
    Pairs upper = pairs(row);
    for (int y = 0; y < kSide; ++y) {
      const Pairs lower = pairs(row += pitch);
      store_words(values[y] + b * kLanes, between(upper, lower, w));
      upper = lower;
    }
  }
  window.xx = window.xy = window.yy = 0;
  for (int y = 0; y < kFlowWindow; ++y) {
    const std::int16_t *a = values[y] + 1, *h = values[y + 1] + 1, *b = values[y + 2] + 1;
    std::int16_t *value = window.value[y], *gx = window.slope_x[y], *gy = window.slope_y[y];
    // 32 of Scharr's sums are a slope of 1: what is left has as many bits behind the point as the values.
    for (int x = 0; x < kFlowWindow; ++x) {
      const int sx = 3 * (a[x + 1] - a[x - 1] + b[x + 1] - b[x - 1]) + 10 * (h[x + 1] - h[x - 1]);
      const int sy = 3 * (b[x - 1] - a[x - 1] + b[x + 1] - a[x + 1]) + 10 * (b[x] - a[x]);
      value[x] = h[x];
      gx[x] = static_cast<std::int16_t>((sx + 16) >> kFlowValueBits);
      gy[x] = static_cast<std::int16_t>((sy + 16) >> kFlowValueBits);
    }
    for (int x = kFlowWindow; x < kFlowStride; ++x) value[x] = gx[x] = gy[x] = 0;
    Words xx = zero(), xy = zero(), yy = zero();
    for (int b16 = 0; b16 < kFlowStride; b16 += kLanes) {
      const Words x = load_words(gx + b16), v = load_words(gy + b16);
      xx = PENUMBRA_WORDS(add_epi32)(xx, PENUMBRA_WORDS(madd_epi16)(x, x));
      xy = PENUMBRA_WORDS(add_epi32)(xy, PENUMBRA_WORDS(madd_epi16)(x, v));
      yy = PENUMBRA_WORDS(add_epi32)(yy, PENUMBRA_WORDS(madd_epi16)(v, v));
    }
    window.xx += sum_of(xx);
    window.xy += sum_of(xy);
    window.yy += sum_of(yy);
  }
}

void flow_mismatch(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights,
                   const FlowWindow& window, std::int64_t* sums) {
  // Rows whose sums fit into 32 bits: a product is at most 8160 * 4080, and an element sums two a row.
  constexpr int kRows = 7;
  static_assert(kFlowWindow % kRows == 0 && 2L * kRows * 8160 * 4080 < 1L << 31);
  const Weights w(weights);
  std::int64_t bx = 0, by = 0;
  for (int b = 0; b < kBlocks; ++b) {
    const std::uint8_t* row = corner + b * kLanes;
    Pairs upper = pairs(row);
    for (int first = 0; first < kFlowWindow; first += kRows) {
      Words x = zero(), v = zero();
      for (int y = first; y < first + kRows; ++y) {
        const Pairs lower = pairs(row += pitch);
        const Words off =
            PENUMBRA_WORDS(sub_epi16)(between(upper, lower, w), load_words(window.value[y] + b * kLanes));
        x = PENUMBRA_WORDS(add_epi32)(
            x, PENUMBRA_WORDS(madd_epi16)(off, load_words(window.slope_x[y] + b * kLanes)));
        v = PENUMBRA_WORDS(add_epi32)(
            v, PENUMBRA_WORDS(madd_epi16)(off, load_words(window.slope_y[y] + b * kLanes)));
        upper = lower;
      }
      bx += sum_of(x);
      by += sum_of(v);
    }
  }
  sums[0] = bx;
  sums[1] = by;
}

void halve_rows(const std::uint8_t* const* rows, int width, std::uint16_t* out) {
  const std::uint8_t *r0 = rows[0], *r1 = rows[1], *r2 = rows[2], *r3 = rows[3], *r4 = rows[4];
  std::uint16_t* __restrict to = out;
  for (int x = 0; x < width; ++x)
    to[x] = static_cast<std::uint16_t>(6 * r2[x] + 4 * (r1[x] + r3[x]) + r0[x] + r4[x]);
}

void halve_columns(const std::uint16_t* columns, int width, std::uint8_t* out) {
  std::uint8_t* __restrict to = out;
  for (int x = 0; x < width; ++x) {
    const std::uint16_t* c = columns + 2 * x;
    to[x] = static_cast<std::uint8_t>((6U * c[0] + 4U * (c[-1] + c[1]) + c[-2] + c[2] + 128U) >> 8);
  }
}

#undef PENUMBRA_WORDS

}  // namespace penumbra::nn::PENUMBRA_ISA
