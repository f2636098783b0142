// The tile registers in memory, and what the instructions do with them, in the same order and rounding; for
// tests on machines that have none. A shape that the processor would refuse traps here, too.
#pragma once

#include <immintrin.h>

#include <cstring>

#include "nn/simd/tile_unit/tiles.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {  // so that no object shares its functions with another

class Tiles {
 public:
  void configure(const TileConfiguration& c) {
    configuration_ = c;
    std::memset(data_, 0, sizeof(data_));
    if (c.palette != 1) __builtin_trap();
    for (int t = 0; t < kTiles; ++t) {
      if (c.rows[t] > kRows || c.column_bytes[t] > kBytes) __builtin_trap();
    }
  }
  void release() { configuration_ = {}; }
  template <int T>
  void zero() {
    std::memset(data_[T], 0, sizeof(data_[T]));
  }
  template <int T>
  void load(const void* from, std::ptrdiff_t stride) {
    zero<T>();
    for (int r = 0; r < rows(T); ++r) {
      std::memcpy(data_[T][r], static_cast<const std::byte*>(from) + r * stride, bytes(T));
    }
  }
  template <int T>
  void store(void* to, std::ptrdiff_t stride) const {
    for (int r = 0; r < rows(T); ++r) {
      std::memcpy(static_cast<std::byte*>(to) + r * stride, data_[T][r], bytes(T));
    }
  }
  template <int C, int A, int B>
  void multiply_bf16() {
    check(C, A, B);
    // Denormal inputs and outputs are 0, rounding is to nearest, whatever the program has set; all exceptions
    // are masked.
    const unsigned before = _mm_getcsr();
    _mm_setcsr(kDenormalsAreZero | kFlushToZero | kMasked);
    add_bf16(C, A, B);
    _mm_setcsr(before);
  }
  template <int C, int A, int B>
  void multiply_int8() {
    check(C, A, B);
    add_int8(C, A, B);
  }

 private:
  static constexpr int kTiles = 8, kRows = 16, kBytes = 64;
  static constexpr unsigned kDenormalsAreZero = 0x40, kFlushToZero = 0x8000, kMasked = 0x1F80;

  int rows(int t) const { return configuration_.rows[t]; }
  int bytes(int t) const { return configuration_.column_bytes[t]; }
  void check(int c, int a, int b) const {
    const bool fits = rows(c) == rows(a) && bytes(c) == bytes(b) && bytes(a) == 4 * rows(b);
    if (configuration_.palette != 1 || rows(c) == 0 || rows(b) == 0 || bytes(c) == 0 || !fits)
      __builtin_trap();
  }

  // A function of its own, so that no arithmetic leaves the lines between the two _mm_setcsr.
  __attribute__((noinline)) void add_bf16(int c, int a, int b) {
    // A pair of bf16 as one 32-bit number: the even one is its lower half.
    const auto upper = [](__m256i pairs) {
      return _mm256_castsi256_ps(_mm256_and_si256(pairs, _mm256_set1_epi32(static_cast<int>(0xFFFF0000U))));
    };
    const auto lower = [](__m256i pairs) { return _mm256_castsi256_ps(_mm256_slli_epi32(pairs, 16)); };
    const int depth = rows(b);
    for (int m = 0; m < rows(c); ++m) {
      for (int n = 0; n < kBytes; n += 32) {  // columns beyond the tile are 0 and stay 0
        __m256 even = _mm256_setzero_ps(), odd = _mm256_setzero_ps();
        for (int k = 0; k < depth; ++k) {
          std::uint32_t pair;
          std::memcpy(&pair, data_[a][m] + 4 * k, 4);
          const __m256i x = _mm256_set1_epi32(static_cast<int>(pair));
          const __m256i w = _mm256_load_si256(reinterpret_cast<const __m256i*>(data_[b][k] + n));
          even = _mm256_fmadd_ps(lower(x), lower(w), even);
          odd = _mm256_fmadd_ps(upper(x), upper(w), odd);
        }
        auto* sum = reinterpret_cast<float*>(data_[c][m] + n);
        _mm256_store_ps(sum, _mm256_add_ps(_mm256_load_ps(sum), _mm256_add_ps(even, odd)));
      }
    }
  }

  void add_int8(int c, int a, int b) {
    // Products of four outputs' groups of four, added up in pairs: 8 numbers.
    const auto pairs = [](const std::uint8_t* w, __m256i x) {
      const __m128i bytes = _mm_load_si128(reinterpret_cast<const __m128i*>(w));
      return _mm256_madd_epi16(x, _mm256_cvtepi8_epi16(bytes));
    };
    for (int m = 0; m < rows(c); ++m) {
      for (int n = 0; n < kBytes; n += 32) {
        auto* sum = reinterpret_cast<__m256i*>(data_[c][m] + n);
        __m256i total = _mm256_load_si256(sum);
        for (int k = 0; k < rows(b); ++k) {
          std::int32_t group;
          std::memcpy(&group, data_[a][m] + 4 * k, 4);
          const __m256i x = _mm256_cvtepu8_epi16(_mm_set1_epi32(group));
          // Outputs 0 1 4 5 2 3 6 7, then in order.
          const __m256i fours = _mm256_hadd_epi32(pairs(data_[b][k] + n, x), pairs(data_[b][k] + n + 16, x));
          total = _mm256_add_epi32(total, _mm256_permute4x64_epi64(fours, 0xD8));
        }
        _mm256_store_si256(sum, total);
      }
    }
  }

  alignas(64) std::uint8_t data_[kTiles][kRows][kBytes] = {};
  TileConfiguration configuration_;
};

}  // namespace

}  // namespace penumbra::nn::PENUMBRA_ISA
