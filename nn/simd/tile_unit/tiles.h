// The tile registers: the processor's own where this is compiled for them (PENUMBRA_TILE_REGISTERS), else an
// emulation. Both have
//
//   configure(c)     LDTILECFG: the shape of every tile; all become 0
//   release()        TILERELEASE
//   zero<T>()        TILEZERO
//   load<T>(p, s)    TILELOADD: the tile's rows from p on, s bytes apart
//   store<T>(p, s)   TILESTORED
//   multiply_bf16<C, A, B>()   TDPBF16PS: C += A B
//   multiply_int8<C, A, B>()   TDPBUSD: the same, A unsigned, B signed
//
// The statements are our own and not the compiler's intrinsics: those of g++ 12 declare 8 of the 64 bytes of
// a configuration as read, and none of a tile, so that the stores before may be left out or come too late.
#pragma once

#include <cstddef>
#include <cstdint>

namespace penumbra::nn::PENUMBRA_ISA {

// What LDTILECFG reads.
struct alignas(64) TileConfiguration {
  std::uint8_t palette = 1, start_row = 0;
  std::uint8_t reserved[14] = {};
  std::uint16_t column_bytes[16] = {};
  std::uint8_t rows[16] = {};
};
static_assert(sizeof(TileConfiguration) == 64);

}  // namespace penumbra::nn::PENUMBRA_ISA

#if defined(PENUMBRA_TILE_REGISTERS)

namespace penumbra::nn::PENUMBRA_ISA {

namespace {  // so that no object shares its functions with another

#define PENUMBRA_INLINE __attribute__((always_inline))

struct Tiles {
  PENUMBRA_INLINE void configure(const TileConfiguration& c) { asm volatile("ldtilecfg %0" : : "m"(c)); }
  PENUMBRA_INLINE void release() { asm volatile("tilerelease"); }
  template <int T>
  PENUMBRA_INLINE void zero() {
    asm volatile("tilezero %%tmm%c0" : : "i"(T));
  }
  template <int T>
  PENUMBRA_INLINE void load(const void* from, std::ptrdiff_t stride) {
    asm volatile("tileloadd (%0,%1,1), %%tmm%c2" : : "r"(from), "r"(stride), "i"(T) : "memory");
  }
  template <int T>
  PENUMBRA_INLINE void store(void* to, std::ptrdiff_t stride) {
    asm volatile("tilestored %%tmm%c2, (%0,%1,1)" : : "r"(to), "r"(stride), "i"(T) : "memory");
  }
  template <int C, int A, int B>
  PENUMBRA_INLINE void multiply_bf16() {
    asm volatile("tdpbf16ps %%tmm%c2, %%tmm%c1, %%tmm%c0" : : "i"(C), "i"(A), "i"(B));
  }
  template <int C, int A, int B>
  PENUMBRA_INLINE void multiply_int8() {
    asm volatile("tdpbusd %%tmm%c2, %%tmm%c1, %%tmm%c0" : : "i"(C), "i"(A), "i"(B));
  }
};

#undef PENUMBRA_INLINE

}  // namespace

}  // namespace penumbra::nn::PENUMBRA_ISA

#else
#include "nn/simd/tile_unit/emulated_tiles.h"
#endif
