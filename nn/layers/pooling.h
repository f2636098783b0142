// Pooling over windows.
//
//   max_pool:   y[n, c, i, j] = max_{u, v < K} x[n, c, i s - p + u, j s - p + v]   over the pixels inside the
//   map subsample:  y[n, c, i, j] = x[n, c, i s, j s]        (max_pool with K = 1; makes P6 from P5) H_out =
//   floor((H + 2 p - K) / s) + 1
//
// Shapes: x [N, C, H, W], y [N, C, H_out, W_out]. Cost: reads x about (K / s)^2 times, writes y once; no
// arithmetic but comparisons. A NaN in the window may or may not survive. Source:
// torch.nn.functional.max_pool2d.
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

}  // namespace penumbra::nn
