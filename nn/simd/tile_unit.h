// The matrix unit that some processors have beside their vector registers (Intel's AMX), as the layers see
// it; docs/engine/tile-units.md explains it by an example.
//
// A tile register holds 16 rows of 64 bytes. One instruction multiplies a tile of inputs (16 pixels, each a
// line of 32 bf16 or 64 8-bit channels) by a tile of weights (those channels by 16 outputs) and adds the
// products to a tile of sums (16 pixels by 16 outputs):
//
//   TDPBF16PS
//     Sums in f32. An instruction's even products are added up by themselves, from 0, and so are its odd
//     ones; both are added, then to the sum. Denormal numbers count as 0.
//   TDPBUSD
//     Sums in 32-bit whole numbers: exact.
//
// There are two of everything here: `amx` runs the processor's instructions, `amx_emulated` computes what
// they would, bit for bit, on any processor with AVX2 and FMA. The kernels around them are the same source.
// Source: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1 chapter 18, volume 2.
#pragma once

#include <cstddef>
#include <cstdint>

#include "nn/simd/kernel_table.h"
#include "nn/simd/numbers.h"

namespace penumbra::nn {

constexpr int kTileRows = 16;          // pixels, or groups of channels
constexpr int kTileOutputs = 16;       // channels of a tile of sums
constexpr int kTileBlockOutputs = 32;  // of two tiles of sums side by side: the width of packed weights
constexpr int kTileBlockSums = 4 * kTileRows * kTileOutputs;  // of 2 x 2 tiles

// How a map's lines lie in memory; distances in bytes. A line is kLineBytes long.
struct LineLayout {
  std::ptrdiff_t pixel_stride = 0;  // from a pixel to the next of a segment
  std::ptrdiff_t block_stride = 0;  // from a pixel's line to its next channels'
  Numbers numbers;
};

// Up to 16 neighbouring output pixels: the rows of a tile.
struct TileSegment {
  const std::byte* input = nullptr;     // the first pixel's first line at tap offset 0
  std::byte* output = nullptr;          // its first line
  const std::byte* residual = nullptr;  // its first line, null for none
  int pixels = 0;
};

// For every pixel of the segments, and output channels o:
//
//   y[o] = act( scale[o] sum_t sum_c x[taps[t] + c] w[t][c][o] + bias[o] + residual[o] )
//
// stored in the output's numbers. Cost: pixels rounded up to 16 x outputs x taps x channels of a line.
// Method: blocks of 2 x 2 tiles of sums, which stay in their registers over all taps, so that every tile of
// inputs or weights that is loaded is used twice.
struct TileUnitArguments {
  Precision precision = Precision::bf16;  // of the products: bf16 or int8
  const TileSegment* segments = nullptr;
  int segment_count = 0;
  std::ptrdiff_t input_pixel_stride = 0;  // bytes, from an output pixel's input to the next one's
  const std::ptrdiff_t* taps = nullptr;   // bytes, of all taps
  int first_tap = 0, tap_count = 0;       // those of this call
  // [outputs / 32][tap][16 groups][32 outputs][group], the last 32 outputs perhaps 16 only; as in
  // packed_weights.h.
  const std::byte* weights = nullptr;    // of the first output, all taps
  std::ptrdiff_t weight_tile_bytes = 0;  // from 32 outputs to the next
  int first_output = 0, outputs = 0;     // a multiple of 32, a multiple of 16
  const float* scale = nullptr;          // [outputs] from the first one on; null for 1
  const float* bias = nullptr;           // [outputs]
  LineLayout output, residual;
  // Where the taps are taken in several calls, so that a part of the weights serves all segments: the sums
  // between them, [outputs / 32][segments / 2][4 tiles][16][16]; null for none.
  float* sums = nullptr;
  bool continued = false;   // starts with `sums`, else with 0
  bool unfinished = false;  // ends with them: outputs are not written
  Activation activation = Activation::none;
  float slope = 0.0F;
  void (*activate)(float* values, std::ptrdiff_t count, Activation activation, float slope) = nullptr;
};

// `pixels` pixels of a map, `channels` of each, from one kind of numbers to another; channels that the first
// map does not hold become 0.
struct ConvertLinesArguments {
  const std::byte* from = nullptr;
  LineLayout from_layout;
  int from_channels = 0;  // rounded up to whole lines, or to 16
  std::byte* to = nullptr;
  LineLayout to_layout;
  int to_channels = 0;
  int pixels = 0;
};

// An image's pixels of four f32 values as eight bf16: the upper parts h = bf16(x) of the four, then their
// remainders bf16(x - h), which together have 16 bits of mantissa.
struct SplitPixelsArguments {
  const float* from = nullptr;
  std::uint16_t* to = nullptr;
  std::ptrdiff_t pixels = 0;
};

// sum[x] = fine[x] + coarse[columns[x]], all of `channels`, a multiple of 16.
struct AddLinesArguments {
  const std::byte* fine = nullptr;
  LineLayout fine_layout;
  const std::byte* coarse = nullptr;
  LineLayout coarse_layout;
  float column_scale = 1.0F;  // columns[x] = min( floor(x column_scale), last_column )
  int last_column = 0;
  std::byte* sum = nullptr;
  LineLayout sum_layout;
  int pixels = 0, channels = 0;
};

// The greatest of rows x columns pixels, for every channel of a line.
struct MaxLineArguments {
  const std::byte* first = nullptr;
  std::ptrdiff_t row_stride = 0;
  int rows = 0, columns = 0;
  Precision precision = Precision::bf16;
  std::byte* output = nullptr;
};

// RoiAlignArguments over all `channels` of a region, in any numbers; row strides in bytes.
struct RoiAlignLinesArguments {
  const std::byte* map = nullptr;
  LineLayout map_layout;
  std::ptrdiff_t map_row_stride = 0;
  const AxisSample* rows = nullptr;
  const AxisSample* columns = nullptr;
  int row_sampling = 0, column_sampling = 0;
  int size = 0, channels = 0;
  std::byte* output = nullptr;
  LineLayout output_layout;
  std::ptrdiff_t output_row_stride = 0;
};

// dots[x] = sum_c weights[c] x[c] over `channels`, a multiple of 16, for pixels side by side.
struct DotLinesArguments {
  const std::byte* first = nullptr;
  LineLayout layout;
  const float* weights = nullptr;
  int pixels = 0, channels = 0;
  float* dots = nullptr;
};

// One instruction, for tests: c += a b with `rows` of c and a, `depth_bytes` of a's rows, which are
// depth_bytes / 4 rows of b, and `column_bytes` of c's and b's. All rows are kLineBytes apart.
struct TileProductArguments {
  Precision precision = Precision::bf16;
  int rows = kTileRows, depth_bytes = kLineBytes, column_bytes = kLineBytes;
  const std::byte* a = nullptr;
  const std::byte* b = nullptr;
  std::byte* c = nullptr;
};

// What is done to maps of narrow numbers besides multiplying: on vector registers, not on the unit.
struct LineKernels {
  void (*convert_lines)(const ConvertLinesArguments&);
  void (*split_pixels)(const SplitPixelsArguments&);
  void (*add_lines)(const AddLinesArguments&);
  void (*max_line)(const MaxLineArguments&);
  void (*roi_align_lines)(const RoiAlignLinesArguments&);
  void (*dot_lines)(const DotLinesArguments&);
};

struct TileUnit {
  void (*multiply)(const TileUnitArguments&);
  LineKernels lines;
  void (*tile_product)(const TileProductArguments&);
  // Runs `iterations` of a loop of tile products that load nothing; returns the operations done.
  double (*peak_loop)(Precision precision, long iterations);
};

// The unit of the instruction set in use, or null where it has none.
const TileUnit* tile_unit();
// Those of narrow maps: of the tile unit, and without one of AVX-512 where it multiplies bf16; else null.
const LineKernels* line_kernels();

namespace amx {
extern const TileUnit kTileUnit;
}
namespace amx_emulated {
extern const TileUnit kTileUnit;
}

}  // namespace penumbra::nn
