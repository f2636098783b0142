// The vector kernels behind the layers, one table per instruction set. What each computes stands with its
// arguments below; the code is in nn/simd/kernels, compiled once for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "nn/simd/activation_kind.h"
#include "nn/simd/image_kernels.h"
#include "nn/simd/isa.h"

namespace penumbra::nn {

// The register tile: for P neighbouring output pixels p and a tile of V output channels o,
//
//   y[p][o] = max( lower_bound, start[p][o] + sum_t sum_c x[p * pixel_stride + taps[t] + c] * w[t][c][o] )
//
// with t over the taps (kernel positions times input blocks), c over the `depth` channels that lie side by
// side at a tap, and start = bias, or what `output` holds where `accumulate` is set; a residual is added at
// the end. One kernel serves every layer that multiplies: convolutions, transposed convolutions, fully
// connected layers and Winograd's products. The sums stay in registers: 14 pixels x 32 channels on AVX-512,
// 6 x 16 on AVX2, 8 x 8 on NEON. Every multiply-add is one fused instruction on all three; per multiply-add
// of 14 x 32 the kernel loads 2 weight vectors and 14 scalars. Cost: P * V * taps * depth multiply-adds.
//
// x and w are f32, or bf16 or 8-bit numbers in the tiles of low_precision.h. Strides count elements of x.
struct TileArguments {
  const void* input = nullptr;            // pixel 0 at tap offset 0
  std::ptrdiff_t input_pixel_stride = 0;  // from an output pixel's input to the next one's
  const std::ptrdiff_t* taps = nullptr;   // offset of every tap
  int tap_count = 0;
  int depth = 0;                    // channels a tap, a multiple of 4
  const void* weights = nullptr;    // [tap][depth][V], 64-byte aligned
  const float* scale = nullptr;     // [V], 8-bit tiles only: what a sum of products of 1 and 1 is worth
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

struct TileKernels {
  int pixels;    // P: most pixels a call
  int channels;  // V of a full tile; a narrow tile (AVX-512 only) has 16
  // full[p - 1] computes p pixels of a full tile, narrow[p - 1] of a 16-channel one.
  std::array<TileFunction, kMaxTilePixels> full;
  std::array<TileFunction, kMaxTilePixels> narrow;
  int group_bytes = 4;   // of weights: so many bytes of an output channel's lie side by side
  int input_offset = 0;  // of 8-bit tiles: what their conversion takes from an input's 0..255
};

// Winograd's transforms of 16 channels; docs/engine/winograd.md derives them, nn/layers/winograd.h uses them.
constexpr int kWinogradOutput = 4;                                   // m: a tile is 4 x 4 output pixels,
constexpr int kWinogradInput = kWinogradOutput + 2;                  // made from 6 x 6 input pixels
constexpr int kWinogradPositions = kWinogradInput * kWinogradInput;  // by 36 products a pair of channels
// The transforms' points are 0, +-a, +-b and infinity; docs/engine/winograd.md says why these.
constexpr float kWinogradA = 23.0F / 32.0F, kWinogradB = 23.0F / 16.0F;

// V = B^T d B for `tiles` neighbouring tiles of a row: d are 6 x 6 input pixels, the next tile's 4 pixels on.
struct WinogradInputArguments {
  const float* input = nullptr;        // the first tile's first pixel; pixels are 16 floats apart
  std::ptrdiff_t row_stride = 0;       // floats
  float* output = nullptr;             // V of the first tile; the next tile's 16 floats on
  std::ptrdiff_t position_stride = 0;  // from one of the 36 numbers to the next
  int tiles = 0;
};

// U = G g G^T of the 3 x 3 kernels of V output channels (the tile's: 8, 16 or 32) and `count` input channels.
constexpr int kWinogradKernel = 9;
struct WinogradWeightArguments {
  const float* input = nullptr;        // [count][9][V]
  float* output = nullptr;             // [count][V] of the first of the 36 numbers
  std::ptrdiff_t position_stride = 0;  // from one of them to the next
  int channels = 0;                    // V
  int count = 0;
};

// y = max( lower_bound, A^T M A + bias + residual ) for `tiles` neighbouring tiles of a row, cut to `rows` x
// `columns` pixels.
struct WinogradOutputArguments {
  const float* input = nullptr;  // M of the first tile; the next tile's 16 floats on
  std::ptrdiff_t position_stride = 0;
  int tiles = 0;
  const float* bias = nullptr;      // [16]
  const float* residual = nullptr;  // null for none; pixels 16 floats apart, as in the output
  std::ptrdiff_t residual_row_stride = 0;
  float* output = nullptr;
  std::ptrdiff_t output_row_stride = 0;
  int rows = 0, columns = 0;  // 1..4, 1..4 tiles
  float lower_bound = 0.0F;
};

// A bilinear sample along one axis: two neighbouring pixels and their weights; both weights are 0 outside the
// map.
struct AxisSample {
  int low = 0, high = 0;
  float low_weight = 0.0F, high_weight = 0.0F;
};

// A region of RoIAlign: y[i][j] is the mean over bin (i, j)'s samples, which are `row_sampling` x
// `column_sampling` of `rows` and `columns`, bin by bin. See nn/layers/roi_align.h.
struct RoiAlignArguments {
  const float* map = nullptr;  // pixel (0, 0) of block 0; pixels are 16 floats apart
  std::ptrdiff_t map_row_stride = 0, map_block_stride = 0;
  int blocks = 0;  // of 16 channels
  const AxisSample* rows = nullptr;
  const AxisSample* columns = nullptr;
  int row_sampling = 0, column_sampling = 0;
  int size = 0;             // bins an axis
  float* output = nullptr;  // bin (0, 0) of block 0; bins are 16 floats apart
  std::ptrdiff_t output_row_stride = 0, output_block_stride = 0;
};

// Boxes side by side, to be compared with one all at once; see nn/layers/nms.h.
constexpr int kBoxLanes = 16;
struct BoxLanes {
  float x1[kBoxLanes], y1[kBoxLanes], x2[kBoxLanes], y2[kBoxLanes], area[kBoxLanes];  // NaN where none is
  int count;
  int before;  // index of the boxes to look at after these; -1 for none
};
// The first of `lanes`, from `first` on, in which a box may overlap this one by an IoU above the threshold,
// or -1. A hundred-thousandth is left for rounding, so that whoever looks again decides exactly.
struct FindOverlapArguments {
  const BoxLanes* lanes = nullptr;
  int first = -1;
  float x1 = 0.0F, y1 = 0.0F, x2 = 0.0F, y2 = 0.0F, area = 0.0F;
  float threshold = 0.0F;  // at least 0
};

// A row of a mixture of feature maps with shares that a softmax gives at every pixel; see nn/layers/asff.h.
//   lambda_k[x] = bias_k + sum_c w_k[c] F_k[c, x / factor_k];   shares = softmax_k(lambda)
//   y[c, x] = sum_k shares_k[x] F_k[c, x / factor_k]
struct MixedLevel {
  const float* row = nullptr;  // pixel 0 of block 0; pixels are 16 floats apart
  std::ptrdiff_t block_stride = 0;
  int factor = 1;                  // by which the level is coarser; divides the width
  const float* weights = nullptr;  // [blocks][16]
  float bias = 0.0F;
};
struct MixRowArguments {
  const MixedLevel* levels = nullptr;
  int level_count = 0;
  int width = 0, blocks = 0;
  float* shares = nullptr;  // [level_count][width]: lambda, then what the softmax makes of it
  float* output = nullptr;  // pixel 0 of block 0
  std::ptrdiff_t output_block_stride = 0;
};

// What one pixel, the query, takes from all pixels of a map; see nn/layers/self_attention.h.
//   scores[i] = exp(sum_d query[d] keys[d][i] - top) / sum
//   output[c] += factor sum_i scores[i] values[c, i]
// `key_stride` is a multiple of 16 and at least `pixels`; keys beyond `pixels` do not matter but are numbers.
struct AttendArguments {
  const float* keys = nullptr;  // [depth][key_stride]
  std::ptrdiff_t key_stride = 0;
  int depth = 0;
  const float* query = nullptr;  // channel 0; the next 16 channels query_block_stride on
  std::ptrdiff_t query_block_stride = 0;
  const float* values = nullptr;  // pixel 0 of block 0; pixels are 16 floats apart
  std::ptrdiff_t value_block_stride = 0;
  int blocks = 0;
  std::ptrdiff_t pixels = 0;
  float factor = 1.0F;
  float* scores = nullptr;  // [key_stride], scratch
  float* output = nullptr;  // block 0
  std::ptrdiff_t output_block_stride = 0;
};

constexpr int kBitRowWords = 4;  // of 64 bits

struct KernelTable {
  const TileKernels* tile;
  void (*winograd_input)(const WinogradInputArguments&);
  void (*winograd_output)(const WinogradOutputArguments&);
  void (*winograd_weights)(const WinogradWeightArguments&);

  // In place, `count` values; `slope` is read by leaky_relu alone. See nn/layers/activations.h.
  void (*activate)(float* values, std::ptrdiff_t count, Activation activation, float slope);
  void (*roi_align)(const RoiAlignArguments&);
  int (*find_overlap)(const FindOverlapArguments&);
  void (*mix_row)(const MixRowArguments&);
  void (*attend)(const AttendArguments&);

  // Runs `iterations` of a loop of independent multiply-adds in registers; returns the floating-point
  // operations done (two a multiply-add): what the processor can do at best.
  double (*peak_loop)(long iterations);

  // differences[i]: in how many of their 256 bits `one` and row i of `rows` differ; kBitRowWords words a row.
  void (*bit_differences)(const std::uint64_t* one, const std::uint64_t* rows, int count,
                          std::uint16_t* differences);

  ImageKernels image;
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
namespace neon {
extern const KernelTable kKernels;
}

}  // namespace penumbra::nn
