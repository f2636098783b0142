// The loop nest around the tile unit (nn/simd/tile_unit.h) that computes a convolution directly.
//
//   over pixels   a task is a patch of output pixels, cut into segments of 16 for the rows of a tile and
//   small
//                 enough for its input to stay in L2 while all output channels pass over it
//   over images   where the output is one pixel an image (fully connected layers): the images take the place
//                 of the pixels, and the taps are cut into panels whose weights stay in L1 while 512 images
//                 pass; so the weights, which are large, stream from memory once. The sums wait in L2
//
// All sums of a task's pixels are finished in it: threads share out output values, and the result does not
// depend on their number. docs/engine/tile-units.md tells more.
#pragma once

#include <cstddef>

#include "nn/layers/activations.h"
#include "nn/layers/packed_weights.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct TileConvolution {
  const PackedWeights* weights = nullptr;
  const std::ptrdiff_t* taps = nullptr;  // bytes, from the first block's pixel on
  int stride = 1, padding = 0;           // of the input
  // The output pixels are (row + i step, column + j step); of a transposed convolution, those of one phase.
  int step = 1, row = 0, column = 0;
  Activation activation = Activation::none;
  float slope = kDefaultSlope;
  const FeatureMap* input = nullptr;     // in the weights' numbers
  const FeatureMap* residual = nullptr;  // any numbers, also the output's; where step is 1
  FeatureMap* output = nullptr;
};

void convolve_on_tiles(const TileConvolution& convolution, Arena& arena);

}  // namespace penumbra::nn
