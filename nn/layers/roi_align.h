// RoIAlign: a fixed-size map for every region of interest, sampled without rounding.
//
// A region (x1, y1, x2, y2) in image pixels is scaled to its level's map, its extent (at least 1 x 1 pixels
// of the map) divided into S x S bins, and every bin averages G x G bilinear samples at its regular
// sub-centres:
//   y[r, c, i, j] = 1/G^2 sum_{u, v < G} F[c, y1 + (i + (u + 0.5)/G) h/S, x1 + (j + (v + 0.5)/G) w/S]
// Samples more than one pixel outside the map are 0; others are clamped to it. Coordinates are "not aligned"
// (no half-pixel shift), as torchvision's detection models use it. The level of a region: k = clamp(floor(4 +
// log2(sqrt(w h) / 224) + 1e-6), 2, 5) - 2 of the levels P2..P5.
//
// Shapes: levels [1, C, H_k, W_k], output [R, C, S, S]. Cost: 4 R C S^2 G^2 multiply-adds.
// Source: He et al. 2017, Mask R-CNN, section 3; torchvision.ops.MultiScaleRoIAlign; reference/roi_align.cpp
// is the oracle.
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
  int size = 7;      // S
  int sampling = 2;  // G
};

// Index of the pyramid level that a region is read from; level 0 is P2.
int roi_level(const Box& box, int levels);

FeatureMap multi_scale_roi_align(std::span<const PyramidLevel> levels, std::span<const Box> regions,
                                 RoiAlignOptions options, Arena& arena, int output_border = 0);

}  // namespace penumbra::nn
