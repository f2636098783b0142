// Maps of narrow numbers between layers, on a tile unit bf16 or 8 bits, on AVX-512 the bf16 that Winograd's
// layers read and write: from one kind of numbers to another, images for the first layer of a tile unit, and
// the sum of the feature pyramid. Error where there are no such kernels (line_kernels of tile_unit.h).
//
//   in_numbers:         y = x, rounded to the new numbers                    shapes and border are kept
//   split_image:        four channels x become eight: h = bf16(x), and x - h, rounded to bf16
//   dot_row:            y[x] = sum_c w[c] x[n, c, row, x]
//   sum_with_upsampled: y[n, c, i, j] = fine[n, c, i, j] + coarse[n, c, floor(i H'/H), floor(j W'/W)]
//
// Cost: one pass over both maps. Error: half a step of the new numbers.
// Source: upsample.h's nearest neighbour; docs/engine/tile-units.md.
#pragma once

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// A map with the same values in other numbers, no image.
FeatureMap in_numbers(const FeatureMap& map, const Numbers& numbers, Arena& arena);

// For a first layer whose products are nearly as exact as in f32: conv2d.h multiplies both parts. An image of
// more than 4 channels is an InputError.
constexpr int kSplitImageBlock = 2 * kImageBlock;
FeatureMap split_image(const FeatureMap& image, Arena& arena);

// One value a pixel of a row; `weights` has one a channel, of which there are whole blocks of 16.
void dot_row(const FeatureMap& map, int n, int row, const float* weights, float* dots);

// Throws InputError where the maps differ in images or channels.
FeatureMap sum_with_upsampled(const FeatureMap& fine, const FeatureMap& coarse, const Numbers& numbers,
                              Arena& arena, int output_border);

}  // namespace penumbra::nn
