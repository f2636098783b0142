// Pooling over windows and over whole maps.
//
//   max_pool:   y[n, c, i, j] = max_{u, v < K} x[n, c, i s - p + u, j s - p + v]
//               over the pixels inside the map
//   avg_pool:   the same with the mean; the divisor is K^2 where the padding counts, else the number of
//               pixels inside the map
//   subsample:  y[n, c, i, j] = x[n, c, i s, j s]         max_pool with K = 1; makes P6 from P5
//               H_out = floor((H + 2 p - K) / s) + 1
//
//   adaptive_avg_pool, adaptive_max_pool:  mean and maximum over the rows floor(i H / H_out) up to
//               ceil((i + 1) H / H_out) - 1, the same for columns
//   global_avg_pool, global_max_pool:      over all pixels; y is [N, C, 1, 1]
//
// Shapes: x [N, C, H, W], y [N, C, H_out, W_out].
// Cost: reads x about (K / s)^2 times, once for the adaptive and global ones; writes y once; one comparison
// or addition a value read. Means are summed row by row, which keeps the rounding error of a large map small.
// A NaN in the window of a maximum may or may not survive.
// Maxima keep the numbers of a narrow map; means are of f32 alone (else InputError).
// Source: torch.nn.functional.max_pool2d, avg_pool2d, adaptive_avg_pool2d; reference/pooling.cpp is the
// oracle.
#pragma once

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct PoolOptions {
  int kernel = 2;
  int stride = 2;
  int padding = 0;  // at most kernel / 2, so that every window holds a pixel
};

FeatureMap max_pool(const FeatureMap& input, PoolOptions options, Arena& arena, int output_border = 0);
inline FeatureMap subsample(const FeatureMap& input, int stride, Arena& arena, int output_border = 0) {
  return max_pool(input, {1, stride, 0}, arena, output_border);
}

// `count_padding`: the zeros of the padding take part in the mean.
FeatureMap avg_pool(const FeatureMap& input, PoolOptions options, bool count_padding, Arena& arena,
                    int output_border = 0);

FeatureMap adaptive_avg_pool(const FeatureMap& input, int height, int width, Arena& arena,
                             int output_border = 0);
FeatureMap adaptive_max_pool(const FeatureMap& input, int height, int width, Arena& arena,
                             int output_border = 0);
FeatureMap global_avg_pool(const FeatureMap& input, Arena& arena, int output_border = 0);
FeatureMap global_max_pool(const FeatureMap& input, Arena& arena, int output_border = 0);

}  // namespace penumbra::nn
