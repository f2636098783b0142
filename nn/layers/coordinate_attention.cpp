#include "nn/layers/coordinate_attention.h"

#include <algorithm>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

Conv2d pointwise(const Tensor& weight, const std::vector<float>& bias, Activation activation) {
  Conv2dOptions options;
  options.activation = activation;
  return {weight, bias, options};
}

// z^h and z^w as maps [N, C, 1, H] and [N, C, 1, W]: their positions side by side, as the convolutions like
// them.
void mean_of_rows_and_columns(const FeatureMap& map, FeatureMap& rows, FeatureMap& columns) {
#pragma omp parallel for collapse(2)
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      float* column = columns.pixel(n, b, 0, 0);
      const std::ptrdiff_t row_values = static_cast<std::ptrdiff_t>(map.width()) * kBlock;
      std::fill_n(column, row_values, 0.0F);
      for (int y = 0; y < map.height(); ++y) {
        const float* f = map.pixel(n, b, y, 0);
        float sum[kBlock] = {};
        for (std::ptrdiff_t x = 0; x < row_values; x += kBlock) {
          for (int c = 0; c < kBlock; ++c) {
            sum[c] += f[x + c];
            column[x + c] += f[x + c];
          }
        }
        float* row = rows.pixel(n, b, 0, y);
        for (int c = 0; c < kBlock; ++c) row[c] = sum[c] / static_cast<float>(map.width());
      }
      for (std::ptrdiff_t x = 0; x < row_values; ++x) column[x] /= static_cast<float>(map.height());
    }
  }
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

void CoordinateAttention::apply(FeatureMap& map, Arena& arena) const {
  FeatureMap rows(arena, map.batch(), map.channels(), 1, map.height(), 0);
  FeatureMap columns(arena, map.batch(), map.channels(), 1, map.width(), 0);
  mean_of_rows_and_columns(map, rows, columns);
  const FeatureMap row_gate = expand_rows_(squeeze_(rows, arena), arena);
  const FeatureMap column_gate = expand_columns_(squeeze_(columns, arena), arena);
#pragma omp parallel for collapse(3)
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        const float* row = row_gate.pixel(n, b, 0, y);
        const float* column = column_gate.pixel(n, b, 0, 0);
        float* f = map.pixel(n, b, y, 0);
        for (int x = 0; x < map.width(); ++x, f += kBlock, column += kBlock) {
          for (int c = 0; c < kBlock; ++c) f[c] *= row[c] * column[c];
        }
      }
    }
  }
}

}  // namespace penumbra::nn
