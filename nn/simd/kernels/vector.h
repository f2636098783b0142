// One vector register of floats of the instruction set that a kernel file is compiled for (PENUMBRA_ISA),
// over xsimd, or as the compiler has it (PENUMBRA_PORTABLE). Only the files of this folder include
// this: everything here is inlined into its instruction set's namespace.
#pragma once

#include <cstdint>

#if defined(PENUMBRA_PORTABLE)
#include "nn/simd/kernels/portable_vector.h"
#else
#include <xsimd/xsimd.hpp>
#endif

namespace penumbra::nn::PENUMBRA_ISA {

#if defined(PENUMBRA_PORTABLE)
using Vector = PortableVector<float>;
using Bytes = PortableVector<std::uint8_t>;
#else
#if defined(__AVX512F__)
using Architecture = xsimd::avx512bw;
#elif defined(__AVX2__)
using Architecture = xsimd::fma3<xsimd::avx2>;
#elif defined(__x86_64__)
using Architecture = xsimd::sse4_2;
#else
using Architecture = xsimd::neon64;
#endif
using Vector = xsimd::batch<float, Architecture>;
using Bytes = xsimd::batch<std::uint8_t, Architecture>;
#endif
constexpr int kLanes = static_cast<int>(Vector::size);
constexpr int kBytes = static_cast<int>(Bytes::size);
constexpr int kBlockLanes = 16;  // channels of a feature map's block
constexpr int kBlockVectors = kBlockLanes / kLanes;

// a * b + c in one rounding where the processor can. xsimd 8.1 multiplies and adds separately on AVX-512, so
// that one is spelled out.
__attribute__((always_inline)) inline Vector madd(const Vector& a, const Vector& b, const Vector& c) {
#if defined(PENUMBRA_PORTABLE)
  return a * b + c;
#elif defined(__AVX512F__)
  return _mm512_fmadd_ps(a, b, c);
#else
  return xsimd::fma(a, b, c);
#endif
}

// From here on the compiler does not know what `v` holds.
__attribute__((always_inline)) inline void forget(Vector& v) {
#if defined(PENUMBRA_PORTABLE)
  asm volatile("" : "+m"(v.data));
#elif defined(__x86_64__)
  asm volatile("" : "+x"(v.data));
#else
  asm volatile("" : "+w"(v.data));
#endif
}

}  // namespace penumbra::nn::PENUMBRA_ISA
