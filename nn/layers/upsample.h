// Resizing of maps: nearest neighbour and bilinear, and the top-down step of a feature pyramid.
//
//   upsample_nearest:   y[n, c, i, j] = x[n, c, floor(i H_x / H_y), floor(j W_x / W_y)]
//   add_upsampled:      y[n, c, i, j] += the same                             docs/papers.md (3)
//   upsample_bilinear:  y[n, c, i, j] = x[n, c] at (s(i, H_x, H_y), s(j, W_x, W_y)),
//                       linear between the four pixels around that place
//     align_corners:      s(i, a, b) = i (a - 1) / (b - 1), 0 where b = 1     corner pixels stay corners
//     otherwise:          s(i, a, b) = max((i + 1/2) a / b - 1/2, 0)          image edges stay edges
//
// The ratio of the extents is rounded to f32 before it is multiplied, as PyTorch does. Extents may shrink,
// too; there is no smoothing.
// Shapes: x [N, C, H_x, W_x], y [N, C, H_y, W_y].
// Cost: nearest reads and writes y's size once; bilinear takes 4 multiply-adds a value.
// Source: Lin et al. 2017, Feature Pyramid Networks, section 3; torch.nn.functional.interpolate;
// reference/upsample.cpp is the oracle.
#pragma once

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

FeatureMap upsample_nearest(const FeatureMap& input, int height, int width, Arena& arena,
                            int output_border = 0);
// To `factor` times the extents.
inline FeatureMap upsample_nearest(const FeatureMap& input, int factor, Arena& arena, int output_border = 0) {
  return upsample_nearest(input, input.height() * factor, input.width() * factor, arena, output_border);
}

void add_upsampled(const FeatureMap& x, FeatureMap& y);

FeatureMap upsample_bilinear(const FeatureMap& input, int height, int width, bool align_corners, Arena& arena,
                             int output_border = 0);

}  // namespace penumbra::nn
