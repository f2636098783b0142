// Nearest-neighbour upsampling to an exact size, added to a map: the top-down step of a feature pyramid.
//
//   add_upsampled:  y[n, c, i, j] += x[n, c, floor(i H_x / H_y), floor(j W_x / W_y)] papers.md (3)
//
// Shapes: x [N, C, H_x, W_x], y [N, C, H_y, W_y]. Cost: N C H_y W_y additions; reads and writes y once.
// Source: Lin et al. 2017, Feature Pyramid Networks, section 3;
// torch.nn.functional.interpolate(mode="nearest").
#pragma once

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

void add_upsampled(const FeatureMap& x, FeatureMap& y);

}  // namespace penumbra::nn
