// RoIAlign: a fixed-size map for every region of interest, sampled without rounding.
//
// A region (x1, y1, x2, y2) in image pixels is scaled to its level's map, its extent divided into S x S bins,
// and every bin averages G_y x G_x bilinear samples at its regular sub-centres:
//   y[r, c, i, j] = 1/(G_y G_x) sum_{u < G_y, v < G_x} F[c, y1 + (i + (u + 0.5)/G_y) h/S,
//                                                           x1 + (j + (v + 0.5)/G_x) w/S]
// Samples more than one pixel outside the map are 0; others are clamped to it.
//   G          the option `sampling`; where that is 0 (adaptive), ceil(h/S) and ceil(w/S)
//   aligned    the region is shifted by half a pixel of the map: coordinates mean pixel edges
//   otherwise  no shift, and the extent is at least 1 x 1 pixels of the map, as in torchvision's detection
//              models
// The level of a region: k = clamp(floor(4 + log2(sqrt(w h) / 224) + 1e-6), 2, 5) - 2 of the levels P2..P5.
//
// Shapes: levels [1, C, H_k, W_k], output [R, C, S, S]. Cost: 4 R C S^2 G^2 multiply-adds.
// Source: He et al. 2017, Mask R-CNN, section 3; torchvision.ops.roi_align, MultiScaleRoIAlign;
// reference/regions.cpp is the oracle.
#pragma once

#include <span>

#include "nn/layers/box.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// One level of a feature pyramid and its scale: map pixels per image pixel (1/4 for P2).
struct PyramidLevel {
  const FeatureMap* map = nullptr;
  float scale = 1.0F;
};

struct RoiAlignOptions {
  int size = 7;          // S
  int sampling = 2;      // G; 0 for adaptive
  bool aligned = false;  // half-pixel shift
};

// Most samples a bin and axis that adaptive sampling takes: a region far larger than its map must not take
// forever.
constexpr int kMaxAdaptiveSampling = 256;

// Index of the pyramid level that a region is read from; level 0 is P2.
int roi_level(const Box& box, int levels);

// In both the output has room for `capacity` regions, or for as many as there are (see Batch).
//
// All regions from one map [1, C, H, W] at `scale` map pixels per image pixel.
FeatureMap roi_align(const FeatureMap& map, float scale, std::span<const Box> regions,
                     RoiAlignOptions options, Arena& arena, int output_border = 0, int capacity = 0);

// Every region from the level that roi_level picks. Where there are kernels for narrow maps (line_kernels of
// tile_unit.h: on a tile unit, and on AVX-512 with bf16), levels and output may be in any numbers, the levels
// all in the same. Throws InputError where there is no level or size or sampling make no sense.
FeatureMap multi_scale_roi_align(std::span<const PyramidLevel> levels, std::span<const Box> regions,
                                 RoiAlignOptions options, Arena& arena, int output_border = 0,
                                 int capacity = 0, const Numbers& output_numbers = {});

}  // namespace penumbra::nn
