#include "nn/layers/coordinate_attention.h"

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

Conv2d pointwise(const Tensor& weight, const std::vector<float>& bias, Activation activation) {
  Conv2dOptions options;
  options.activation = activation;
  return {weight, bias, options};
}

constexpr int kStrips = 8;  // of rows, summed apart: as many on any number of threads

// z^h and z^w side by side, as a map [N, C, 1, H + W]: its positions are neighbours, as convolutions like
// them.
FeatureMap means_of_rows_and_columns(const FeatureMap& map, Arena& arena) {
  const int height = map.height(), strips = std::min(kStrips, height);
  const std::ptrdiff_t row_values = static_cast<std::ptrdiff_t>(map.width()) * kBlock;
  FeatureMap means(arena, map.batch(), map.channels(), 1, height + map.width(), 0);
  FeatureMap parts(arena, map.batch(), map.channels(), strips, map.width(), 0);  // of the columns' sums
  parallel_for({map.images(), map.blocks(), strips}, grain_of(map.block_stride() / strips),
               [&](int n, int b, int s) {
                 float* column = parts.pixel(n, b, s, 0);
                 std::fill_n(column, row_values, 0.0F);
                 for (int y = s * height / strips; y < (s + 1) * height / strips; ++y) {
                   const float* f = map.pixel(n, b, y, 0);
                   float sum[kBlock] = {};
                   for (std::ptrdiff_t x = 0; x < row_values; x += kBlock) {
                     for (int c = 0; c < kBlock; ++c) {
                       sum[c] += f[x + c];
                       column[x + c] += f[x + c];
                     }
                   }
                   float* row = means.pixel(n, b, 0, y);
                   for (int c = 0; c < kBlock; ++c) row[c] = sum[c] / static_cast<float>(map.width());
                 }
               });
  parallel_for({map.images(), map.blocks()}, grain_of(strips * row_values), [&](int n, int b) {
    float* column = means.pixel(n, b, 0, height);
    std::fill_n(column, row_values, 0.0F);
    for (int s = 0; s < strips; ++s) {
      const float* part = parts.pixel(n, b, s, 0);
      for (std::ptrdiff_t x = 0; x < row_values; ++x) column[x] += part[x];
    }
    for (std::ptrdiff_t x = 0; x < row_values; ++x) column[x] /= static_cast<float>(height);
  });
  return means;
}

// F <- x + F g^h g^w, or without x.
template <bool kShortcut>
void multiply_gates(FeatureMap& map, const FeatureMap& row_gates, const FeatureMap& column_gates,
                    const FeatureMap* shortcut) {
  parallel_for({map.images(), map.blocks(), map.height()}, grain_of(map.row_stride()),
               [&](int n, int b, int y) {
                 float row[kBlock];  // a copy, which stays in registers
                 std::copy_n(row_gates.pixel(n, b, 0, y), kBlock, row);
                 const float* column = column_gates.pixel(n, b, 0, map.height());
                 const float* x = kShortcut ? shortcut->pixel(n, b, y, 0) : nullptr;
                 float* f = map.pixel(n, b, y, 0);
                 for (int j = 0; j < map.width(); ++j, f += kBlock, column += kBlock) {
                   for (int c = 0; c < kBlock; ++c) {
                     f[c] = f[c] * (row[c] * column[c]) + (kShortcut ? x[c] : 0.0F);
                   }
                   if (kShortcut) x += kBlock;
                 }
               });
}

}  // namespace

CoordinateAttention::CoordinateAttention(const CoordinateAttentionWeights& weights) {
  const Shape& shape = weights.squeeze.shape;
  if (shape.size() != 4 || shape[2] != 1 || shape[3] != 1 ||
      weights.expand_rows.shape != Shape{shape[1], shape[0], 1, 1} ||
      weights.expand_columns.shape != weights.expand_rows.shape) {
    throw InputError("coordinate attention", "weights [M, C, 1, 1] and twice [C, M, 1, 1]",
                     to_string(shape) + ", " + to_string(weights.expand_rows.shape) + ", " +
                         to_string(weights.expand_columns.shape));
  }
  squeeze_ = pointwise(weights.squeeze, weights.squeeze_bias, Activation::hard_swish);
  expand_rows_ = pointwise(weights.expand_rows, weights.expand_rows_bias, Activation::sigmoid);
  expand_columns_ = pointwise(weights.expand_columns, weights.expand_columns_bias, Activation::sigmoid);
}

void CoordinateAttention::apply(FeatureMap& map, Arena& arena, const FeatureMap* shortcut) const {
  // Each gate is computed at the other's positions, too: that is cheaper than taking f apart.
  const FeatureMap f = squeeze_(means_of_rows_and_columns(map, arena), arena);
  const FeatureMap row_gates = expand_rows_(f, arena), column_gates = expand_columns_(f, arena);
  if (shortcut != nullptr) {
    multiply_gates<true>(map, row_gates, column_gates, shortcut);
  } else {
    multiply_gates<false>(map, row_gates, column_gates, nullptr);
  }
}

}  // namespace penumbra::nn
