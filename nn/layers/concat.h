// Joining maps along their channels and taking them apart again.
//
//   concat:          y[n, :, i, j] = [ x_1[n, :, i, j] ; x_2[n, :, i, j] ; ... ]
//   slice_channels:  y[n, c, i, j] = x[n, first + c, i, j],  0 <= c < count
//   split:           slices that follow one another and take all channels
//
// Shapes: x_k [N, C_k, H, W], y [N, sum C_k, H, W]; channel counts are free.
// Cost: one read and one write of every value. Where a part starts within a block of 16, its lanes move pixel
// by pixel, else whole rows are copied.
// Source: torch.cat, torch.narrow, torch.split with dim 1; reference/elementwise.cpp is the oracle.
#pragma once

#include <span>
#include <vector>

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// At least one map; all in blocks of 16 and of one size.
FeatureMap concat(std::span<const FeatureMap* const> maps, Arena& arena, int output_border = 0);

FeatureMap slice_channels(const FeatureMap& map, int first, int count, Arena& arena, int output_border = 0);

// Parts of `channels[k]` channels each; they must add up to the map's.
std::vector<FeatureMap> split(const FeatureMap& map, std::span<const int> channels, Arena& arena,
                              int output_border = 0);

}  // namespace penumbra::nn
