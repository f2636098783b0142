// The vector kernels of one instruction set: this file is compiled once for each, with PENUMBRA_ISA naming
// it. kernel_table.h says what they compute.

#include <utility>

#include "nn/simd/kernel_table.h"
#include "nn/simd/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

// Registers: P * kTileVectors sums, kTileVectors weights, one broadcast input (and one product without FMA).
#if defined(__AVX512F__)
constexpr int kTilePixels = 14;  // 28 + 2 + 1 of 32 registers
#elif defined(__AVX2__)
constexpr int kTilePixels = 6;  // 12 + 2 + 1 of 16
#else
constexpr int kTilePixels = 6;  // 12 + 2 + 1 + 1 of 16
#endif
constexpr int kTileVectors = 2;
constexpr int kUnroll = 4;  // channels per step of the inner loop
constexpr int kBlockLanes = 16;

// Offset of a tile's vector `v` in a channel-blocked map whose blocks are `block_stride` apart.
constexpr std::ptrdiff_t vector_offset(int v, std::ptrdiff_t block_stride) {
  return v * kLanes / kBlockLanes * block_stride + v * kLanes % kBlockLanes;
}

// The multiply-adds of P pixels x V vectors. PixelStride is the input's pixel stride, so that every load's
// address is one register plus a constant; 0 means that it is known at run time only.
template <int P, int V, int PixelStride>
__attribute__((always_inline)) inline void accumulate(const TileArguments& a, Vector (&sum)[P][V]) {
  const float* weights = a.weights;
  const std::ptrdiff_t stride = PixelStride != 0 ? PixelStride : a.input_pixel_stride;
  for (int t = 0; t < a.tap_count; ++t) {
    const float* x = a.input + a.taps[t];
    for (int c0 = 0; c0 < a.depth; c0 += kUnroll, x += kUnroll, weights += kUnroll * V * kLanes) {
#pragma GCC unroll 4
      for (int c = 0; c < kUnroll; ++c) {
        Vector w[V];
#pragma GCC unroll 2
        for (int v = 0; v < V; ++v) w[v] = Vector::load_aligned(weights + (c * V + v) * kLanes);
#pragma GCC unroll 14
        for (int p = 0; p < P; ++p) {
          const Vector input(x[p * stride + c]);
#pragma GCC unroll 2
          for (int v = 0; v < V; ++v) sum[p][v] = madd(input, w[v], sum[p][v]);
        }
      }
    }
  }
}

template <int P, int V>
void tile(const TileArguments& a) {
  Vector sum[P][V];
#pragma GCC unroll 14
  for (int p = 0; p < P; ++p) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) {
      sum[p][v] = a.accumulate ? Vector::load_unaligned(a.output + p * a.output_pixel_stride +
                                                        vector_offset(v, a.output_block_stride))
                               : Vector::load_unaligned(a.bias + v * kLanes);
    }
  }

  switch (a.input_pixel_stride) {
    case 8:  // the stem: stride 2 over an image of 4-channel pixels
      accumulate<P, V, 8>(a, sum);
      break;
    case 16:  // stride 1
      accumulate<P, V, 16>(a, sum);
      break;
    case 32:  // stride 2
      accumulate<P, V, 32>(a, sum);
      break;
    default:
      accumulate<P, V, 0>(a, sum);
  }

  const Vector lower_bound(a.lower_bound);
#pragma GCC unroll 14
  for (int p = 0; p < P; ++p) {
#pragma GCC unroll 2
    for (int v = 0; v < V; ++v) {
      Vector y = sum[p][v];
      if (a.residual != nullptr) {
        y += Vector::load_unaligned(a.residual + p * a.residual_pixel_stride +
                                    vector_offset(v, a.residual_block_stride));
      }
      // In this order the instruction keeps a NaN of y.
      xsimd::max(lower_bound, y)
          .store_unaligned(a.output + p * a.output_pixel_stride + vector_offset(v, a.output_block_stride));
    }
  }
}

template <int V, int... I>
constexpr std::array<TileFunction, kMaxTilePixels> tiles(std::integer_sequence<int, I...>) {
  return {tile<I + 1, V>...};
}

// As many independent sums as the tile has, so that the latency of a multiply-add is hidden as it is there.
double peak_loop(long iterations) {
  Vector sum[kTilePixels * kTileVectors];
  for (auto& s : sum) s = Vector(1.0F);
  Vector a(0.999F), b(1e-3F);
  for (long i = 0; i < iterations; ++i) {
    // The compiler may not know a and b, else it would fold the loop away.
    asm volatile("" : "+x"(a), "+x"(b));
#pragma GCC unroll 28
    for (auto& s : sum) s = madd(s, a, b);
  }
  Vector total(0.0F);
  for (const auto& s : sum) total += s;
  volatile float keep = total.get(0);
  static_cast<void>(keep);
  return 2.0 * static_cast<double>(iterations) * kTilePixels * kTileVectors * kLanes;
}

constexpr auto kPixelCounts = std::make_integer_sequence<int, kTilePixels>{};

}  // namespace

extern const KernelTable kKernels;
const KernelTable kKernels = {
    kTilePixels, kTileVectors* kLanes, tiles<kTileVectors>(kPixelCounts),
    // A 16-channel tile where the full one is wider.
    tiles<(kTileVectors * kLanes > kBlockLanes ? kBlockLanes / kLanes : kTileVectors)>(kPixelCounts),
    peak_loop};

}  // namespace penumbra::nn::PENUMBRA_ISA
