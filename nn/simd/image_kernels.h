// The vector kernels behind nn/image: rows of 8-bit pixels. Formulas, borders and rounding stand with the
// operations that use them (nn/image/*.h); the code is in nn/simd/kernels. None reads a pixel that its
// arguments do not name, none keeps anything.
#pragma once

#include <cstddef>
#include <cstdint>

namespace penumbra::nn {

// Two neighbouring bytes of a row, mixed: 8 output pixels come from the 16 bytes at `begin`, by byte numbers.
struct ResizeBlock {
  std::int32_t begin = 0;
  std::uint8_t low_bytes[16] = {},
               high_bytes[16] = {};  // of pshufb: 4 pixels each, two 16-bit numbers a pixel
};

struct ResizeRowArguments {
  const std::uint8_t* row = nullptr;
  const ResizeBlock* blocks = nullptr;  // one per 8 whole output pixels of the vector part
  int block_count = 0;
  const std::int32_t* columns = nullptr;  // left neighbour of each output pixel
  const std::int16_t* weights = nullptr;  // two an output pixel, their sum is 2048
  int right = 1;                          // columns from the left to the right neighbour: 0 in images of one
  int width = 0;                          // of the output
  std::int16_t* out = nullptr;            // (left * w0 + right * w1) / 16
};

// Of remap: sample i lies between the pixel at places[2 i], places[2 i + 1] (column, row) and the ones right
// of it and below, dx[i] and dy[i] 32nds of a pixel, 0..32, from it.
struct RemapRowArguments {
  const std::uint8_t* image = nullptr;
  std::ptrdiff_t pitch = 0;
  int channels = 1;  // 1 or 3
  const std::int16_t* places = nullptr;
  const std::uint8_t *dx = nullptr, *dy = nullptr;
  int width = 0;
  std::uint8_t* out = nullptr;
};

// The window of nn/image/point_flow.h around a point: values and slopes with kFlowValueBits behind the point,
// rows padded with zeros, and the sums of the slopes' products.
constexpr int kFlowWindow = 21, kFlowStride = 32;  // pixels a side, and from row to row
constexpr int kFlowValueBits = 5, kFlowWeightBits = 14;
struct FlowWindow {
  std::int16_t value[kFlowWindow][kFlowStride];
  std::int16_t slope_x[kFlowWindow][kFlowStride], slope_y[kFlowWindow][kFlowStride];
  std::int64_t xx, xy, yy;
};

// What disc_moments weighs pixels by, those of a disc of radius kDiscRadius: 1 and the column from the
// centre, 0 outside of the disc.
constexpr int kDiscRadius = 15, kDiscRows = 2 * kDiscRadius + 1, kDiscStride = 32;
struct DiscWeights {
  std::int8_t one[kDiscRows][kDiscStride] = {};
  std::int8_t column[kDiscRows][kDiscStride] = {};
};

// patch_differences compares patches of kDifferenceSide pixels a side at so many places.
constexpr int kDifferenceReach = 5, kDifferenceSide = 2 * kDifferenceReach + 1;

struct ImageKernels {
  // scores[i] of `count` pixels: how much brighter, or darker, than the centre all of the best 9 neighbours
  // in a row on the circle of 16 are, less 1; 0 where that is below `threshold`. See nn/image/fast_corners.h.
  void (*fast_scores)(const std::uint8_t* centre, std::ptrdiff_t pitch, int count, int threshold,
                      std::uint8_t* scores);
  // is_peak[i] = 1 where here[i] >= least and here[i] > all of its 8 neighbours, 0 elsewhere. The rows have a
  // pixel more at both ends.
  void (*peaks)(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int count,
                int least, std::uint8_t* is_peak);
  // out = w0 rows[3] + w1 (rows[2] + rows[4]) + w2 (rows[1] + rows[5]) + w3 (rows[0] + rows[6]), and
  // out = (the same of columns[-3..3], + 1/2 of 65536) / 65536: the weights of distances 0..3 are 256ths.
  void (*blur_rows)(const std::uint8_t* const* rows, const std::uint8_t* weights, int width, float* out);
  void (*blur_columns)(const float* columns, const std::uint8_t* weights, int width, std::uint8_t* out);
  void (*resize_row)(const ResizeRowArguments& a);
  // out = ((upper * w0) / 65536 + (lower * w1) / 65536 + 2) / 4, of what resize_row made.
  void (*resize_mix)(const std::int16_t* upper, const std::int16_t* lower, int w0, int w1, int width,
                     std::uint8_t* out);
  void (*remap_row)(const RemapRowArguments& a);
  // Sum of q = gx^2 + gy^2 over a row where q > least; g: Sobel's sums over 3 x 3 pixels. The rows have a
  // pixel more at both ends.
  std::uint64_t (*slope_energy)(const std::uint8_t* above, const std::uint8_t* here,
                                const std::uint8_t* below, int count, int least);
  // Grey of `count` pixels of blue, green and red.
  void (*grey_row)(const std::uint8_t* bgr, int count, std::uint8_t* grey);
  // The window whose upper left corner lies between the pixel `corner` and the ones right of it and below, by
  // the weights of the four; a pixel around it, and one more to the right and below, is read too. Both
  // functions may also read, but do not use, kFlowStride + 1 bytes of each row from its first on.
  void (*flow_window)(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights,
                      FlowWindow& window);
  // sums = sum over the window of (value here - value of `window`) * slope_x, and * slope_y.
  void (*flow_mismatch)(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights,
                        const FlowWindow& window, std::int64_t* sums);
  // out = rows[0] + 4 rows[1] + 6 rows[2] + 4 rows[3] + rows[4], and
  // out[x] = (the same of columns[2 x - 2 .. 2 x + 2] + 128) / 256.
  void (*halve_rows)(const std::uint8_t* const* rows, int width, std::uint16_t* out);
  void (*halve_columns)(const std::uint16_t* columns, int width, std::uint8_t* out);
  // m10 = sum x I(x, y), m01 = sum y I(x, y) over the disc around `centre`; reads 15 pixels to all sides, and
  // 16 to the right.
  void (*disc_moments)(const std::uint8_t* centre, std::ptrdiff_t pitch, const DiscWeights& weights, int* m10,
                       int* m01);
  // sums[s + 5] = sum over -5 <= x, y <= 5 of |(left(x, y) - left(0, 0)) - (right(x + s, y) - right(s, 0))|,
  // -5 <= s <= 5: how unlike the patch around `left` and those around the pixels beside `right` are, but for
  // their brightness. May also read, but does not use, 16 bytes of each row from each patch's first on.
  void (*patch_differences)(const std::uint8_t* left, std::ptrdiff_t left_pitch, const std::uint8_t* right,
                            std::ptrdiff_t right_pitch, int* sums);
};

}  // namespace penumbra::nn
