// The register tile as a template over the kind of number: kernel_table.h says what it computes,
// docs/engine/fast-convolution.md how it came about. Functions are static: each instruction set has its own.
//
// A Number tells how to multiply:
//   Element     what inputs and weights are stored as
//   kGroup      channels that fill 32 bits (1 for f32)
//   Sum         a register of sums;  zero()  makes one
//   finish      the sums as f32
//   Group       a register that holds one group of channels of a pixel in every lane;  broadcast(x)  fills it
//   Weights     a register of weights;  load(w)  fills it
//   multiply    sum + group * weights
// A Number of NEON's (neon_steps.h) has kOwnSteps and, instead of the last three, a step of the loop; with
// kPairs its sums are those of two pixels, which  separate  sorts.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "nn/simd/kernel_table.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

// Registers: P * kTileVectors sums, kTileVectors weights, one broadcast input (and one product without FMA).
#if defined(__AVX512F__)
constexpr int kTilePixels = 14;  // 28 + 2 + 1 of 32 registers
#elif defined(PENUMBRA_NEON)
constexpr int kTilePixels = 8;  // 16 + 2 + 8 of 32: four channels of every pixel are in registers, too
#else
constexpr int kTilePixels = 6;  // 12 + 2 + 1 (+ 1) of 16
#endif
constexpr int kTileVectors = 2;
constexpr int kTileChannels = kTileVectors * kLanes;
// A 16-channel tile where the full one is wider.
constexpr int kNarrowVectors = kTileChannels > kBlockLanes ? kBlockLanes / kLanes : kTileVectors;
constexpr int kUnroll = 4;  // groups of channels per step of the inner loop; depth is a multiple

// Rows of sums of P pixels.
template <class Number, int P>
constexpr int kSumRows = Number::kPairs ? (P + 1) / 2 * 2 : P;

// Offset of a tile's vector `v` in a channel-blocked map whose blocks are `block_stride` apart.
constexpr std::ptrdiff_t vector_offset(int v, std::ptrdiff_t block_stride) {
  return v * kLanes / kBlockLanes * block_stride + v * kLanes % kBlockLanes;
}

// The multiply-adds of P pixels x V vectors. PixelStride is the input's pixel stride, so that every load's
// address is one register plus a constant; 0 means that it is known at run time only.
template <class Number, int P, int V, int PixelStride>
__attribute__((always_inline)) static inline void accumulate(
    const TileArguments& a, typename Number::Sum (&sum)[kSumRows<Number, P>][V]) {
  using Element = typename Number::Element;
  constexpr int kGroup = Number::kGroup, kStep = kUnroll * kGroup;
  const Element* weights = static_cast<const Element*>(a.weights);
  const std::ptrdiff_t stride = PixelStride != 0 ? PixelStride : a.input_pixel_stride;
  for (int t = 0; t < a.tap_count; ++t) {
    const Element* x = static_cast<const Element*>(a.input) + a.taps[t];
    for (int c0 = 0; c0 < a.depth; c0 += kStep, x += kStep, weights += kStep * V * kLanes) {
      if constexpr (Number::kOwnSteps) {
        Number::template step<P, V>(x, stride, weights, sum);
      } else {
#pragma GCC unroll 4
        for (int c = 0; c < kStep; c += kGroup) {
          typename Number::Weights w[V];
#pragma GCC unroll 2
          for (int v = 0; v < V; ++v) w[v] = Number::load(weights + (c * V + v * kGroup) * kLanes);
#pragma GCC unroll 14
          for (int p = 0; p < P; ++p) {
            const typename Number::Group input = Number::broadcast(x + p * stride + c);
#pragma GCC unroll 2
            for (int v = 0; v < V; ++v) sum[p][v] = Number::multiply(input, w[v], sum[p][v]);
          }
        }
      }
    }
  }
}

template <class Number, int P, int V>
static void tile(const TileArguments& a) {
  typename Number::Sum sum[kSumRows<Number, P>][V];
#pragma GCC unroll 14
  for (int p = 0; p < kSumRows<Number, P>; ++p) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) sum[p][v] = Number::zero();
  }

  switch (a.input_pixel_stride) {
    case 8:  // the stem: stride 2 over an image of 4-channel pixels; always f32
      accumulate<Number, P, V, Number::kGroup == 1 ? 8 : 0>(a, sum);
      break;
    case 16:  // stride 1
      accumulate<Number, P, V, 16>(a, sum);
      break;
    case 32:  // stride 2
      accumulate<Number, P, V, 32>(a, sum);
      break;
    default:
      accumulate<Number, P, V, 0>(a, sum);
  }

  if constexpr (Number::kPairs) Number::separate(sum);
  const Vector lower_bound(a.lower_bound);
#pragma GCC unroll 14
  for (int p = 0; p < P; ++p) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) {
      float* out = a.output + p * a.output_pixel_stride + vector_offset(v, a.output_block_stride);
      const float* start = a.accumulate ? out : a.bias + v * kLanes;
      Vector y = Number::finish(sum[p][v], a, v) + Vector::load_unaligned(start);
      if (a.residual != nullptr) {
        y += Vector::load_unaligned(a.residual + p * a.residual_pixel_stride +
                                    vector_offset(v, a.residual_block_stride));
      }
      max(lower_bound, y).store_unaligned(out);  // in this order the instruction keeps a NaN of y
    }
  }
}

template <class Number, int V, int... I>
static constexpr std::array<TileFunction, kMaxTilePixels> tiles(std::integer_sequence<int, I...>) {
  return {tile<Number, I + 1, V>...};
}

// `input_offset` as TileKernels has it.
template <class Number>
static constexpr TileKernels register_tile(int input_offset = 0) {
  constexpr auto kPixelCounts = std::make_integer_sequence<int, kTilePixels>{};
  return {kTilePixels,
          kTileChannels,
          tiles<Number, kTileVectors>(kPixelCounts),
          tiles<Number, kNarrowVectors>(kPixelCounts),
          Number::kPairs ? 8 : 4,
          input_offset};
}

}  // namespace penumbra::nn::PENUMBRA_ISA
