// A region of RoIAlign: kernel_table.h says what it computes.
//
// A bin's taps, places in the map and their weights, are the same for all channels. They are worked out once
// for some blocks of channels, whose sums then grow together: a weight that is loaded serves all of them, and
// no sum waits for the one before it. More blocks together would not leave their pixels in the L1 cache from
// one row of bins to the next.

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr int kMostTaps = 64;  // at a time: 4 x 4 samples
constexpr int kBlocksTogether = kBlockVectors <= 2 ? 4 : 2;

struct Taps {
  std::ptrdiff_t places[kMostTaps];
  float weights[kMostTaps];
  int count = 0;

  void add(std::ptrdiff_t place, float weight) {
    places[count] = place;
    weights[count++] = weight;
  }
};

// The sums of B blocks of a bin.
template <int B>
struct Sums {
  Vector values[B][kBlockVectors];

  __attribute__((always_inline)) Sums() {
    for (auto& block : values) {
      for (auto& value : block) value = Vector(0.0F);
    }
  }
  __attribute__((always_inline)) void add(const float* map, std::ptrdiff_t block_stride, const Taps& taps) {
    for (int t = 0; t < taps.count; ++t) {
      const Vector weight(taps.weights[t]);
      const float* tap = map + taps.places[t];
      for (int b = 0; b < B; ++b) {
        for (int k = 0; k < kBlockVectors; ++k) {
          const Vector pixel = Vector::load_unaligned(tap + b * block_stride + k * kLanes);
          values[b][k] = madd(weight, pixel, values[b][k]);
        }
      }
    }
  }
};

template <int B>
__attribute__((always_inline)) inline void align_blocks(const RoiAlignArguments& a, int first_block) {
  const float* const map = a.map + first_block * a.map_block_stride;
  float* const output = a.output + first_block * a.output_block_stride;
  const int samples = a.row_sampling * a.column_sampling;
  const Vector share(samples > 0 ? 1.0F / static_cast<float>(samples) : 1.0F);
  Taps taps;
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < a.size; ++j) {
      Sums<B> sums;
      for (int u = 0; u < a.row_sampling; ++u) {
        const AxisSample& row = a.rows[i * a.row_sampling + u];
        const std::ptrdiff_t upper = row.low * a.map_row_stride, lower = row.high * a.map_row_stride;
        for (int v = 0; v < a.column_sampling; ++v) {
          if (taps.count == kMostTaps) {
            sums.add(map, a.map_block_stride, taps);
            taps.count = 0;
          }
          const AxisSample& column = a.columns[j * a.column_sampling + v];
          const int left = column.low * kBlockLanes, right = column.high * kBlockLanes;
          taps.add(upper + left, row.low_weight * column.low_weight);
          taps.add(upper + right, row.low_weight * column.high_weight);
          taps.add(lower + left, row.high_weight * column.low_weight);
          taps.add(lower + right, row.high_weight * column.high_weight);
        }
      }
      sums.add(map, a.map_block_stride, taps);
      taps.count = 0;
      float* const bin = output + i * a.output_row_stride + j * kBlockLanes;
      for (int b = 0; b < B; ++b) {
        for (int k = 0; k < kBlockVectors; ++k) {
          (sums.values[b][k] * share).store_unaligned(bin + b * a.output_block_stride + k * kLanes);
        }
      }
    }
  }
}

}  // namespace

void roi_align(const RoiAlignArguments& a) {
  int b = 0;
  for (; b + kBlocksTogether <= a.blocks; b += kBlocksTogether) align_blocks<kBlocksTogether>(a, b);
  for (; b < a.blocks; ++b) align_blocks<1>(a, b);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
