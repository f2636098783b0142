// The vector kernels behind the layers, one table per instruction set.
//
// One register-tile kernel serves every layer that multiplies: convolutions, transposed convolutions and
// fully connected layers. It computes, for P neighbouring output pixels p and a tile of V output channels o,
//
//   y[p][o] = max( lower_bound, start[p][o] + sum_t sum_c x[p * pixel_stride + taps[t] + c] * w[t][c][o] )
//
// with t over the taps (kernel positions times input blocks), c over the `depth` channels that lie side by
// side at a tap, and start = bias (+ residual), or what `output` holds where `accumulate` is set. The sums
// stay in registers: 14 pixels x 32 channels on AVX-512, 6 x 16 on AVX2. Every multiply-add is one fused
// instruction on both; per multiply-add of 14 x 32 the kernel loads 2 weight vectors and 14 scalars. Cost: P
// * V * taps * depth multiply-adds.
#pragma once

#include <array>
#include <cstddef>

#include "nn/simd/isa.h"

namespace penumbra::nn {

struct TileArguments {
  const float* input = nullptr;           // pixel 0 at tap offset 0
  std::ptrdiff_t input_pixel_stride = 0;  // floats from an output pixel's input to the next one's
  const std::ptrdiff_t* taps = nullptr;   // offset of every tap in floats
  int tap_count = 0;
  int depth = 0;                    // channels a tap, a multiple of 4
  const float* weights = nullptr;   // [tap][depth][V], 64-byte aligned
  const float* bias = nullptr;      // [V]
  const float* residual = nullptr;  // null for none
  std::ptrdiff_t residual_pixel_stride = 0;
  std::ptrdiff_t residual_block_stride = 0;  // from the tile's first 16 channels to the next 16
  float* output = nullptr;
  std::ptrdiff_t output_pixel_stride = 0;
  std::ptrdiff_t output_block_stride = 0;
  float lower_bound = 0.0F;  // 0 for ReLU, -infinity for none
  bool accumulate = false;
};

using TileFunction = void (*)(const TileArguments&);

constexpr int kMaxTilePixels = 14;

struct KernelTable {
  int tile_pixels;    // P: most pixels a call
  int tile_channels;  // V of a full tile; a narrow tile (AVX-512 only) has 16
  // tile[p - 1] computes p pixels of a full tile, narrow_tile[p - 1] of a 16-channel one.
  std::array<TileFunction, kMaxTilePixels> tile;
  std::array<TileFunction, kMaxTilePixels> narrow_tile;
  // Runs `iterations` of a loop of independent multiply-adds in registers; returns the floating-point
  // operations done (two a multiply-add): what the processor can do at best.
  double (*peak_loop)(long iterations);
};

// The table of the current instruction set.
const KernelTable& kernels();

namespace baseline {
extern const KernelTable kKernels;
}
namespace avx2 {
extern const KernelTable kKernels;
}
namespace avx512 {
extern const KernelTable kKernels;
}

}  // namespace penumbra::nn
