// One vector register of floats of the instruction set that a kernel file is compiled for (PENUMBRA_ISA),
// over xsimd. Only the files of this folder include this: everything here is inlined into its instruction
// set's namespace.
#pragma once

#include <xsimd/xsimd.hpp>

namespace penumbra::nn::PENUMBRA_ISA {

#if defined(__AVX512F__)
using Architecture = xsimd::avx512bw;
#elif defined(__AVX2__)
using Architecture = xsimd::fma3<xsimd::avx2>;
#else
using Architecture = xsimd::sse4_2;
#endif

using Vector = xsimd::batch<float, Architecture>;
constexpr int kLanes = static_cast<int>(Vector::size);
constexpr int kBlockLanes = 16;  // channels of a feature map's block
constexpr int kBlockVectors = kBlockLanes / kLanes;

// a * b + c in one rounding where the processor can. xsimd 8.1 multiplies and adds separately on AVX-512, so
// that one is spelled out.
__attribute__((always_inline)) inline Vector madd(const Vector& a, const Vector& b, const Vector& c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_ps(a, b, c);
#else
  return xsimd::fma(a, b, c);
#endif
}

}  // namespace penumbra::nn::PENUMBRA_ISA
