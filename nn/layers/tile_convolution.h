// The loop nest around the tile unit (nn/simd/tile_unit.h) that computes a convolution directly.
//
//   over pixels
//     A task is a patch of output pixels, cut into segments of 16 for the rows of a tile and small enough for
//     its input to stay in L2 while all output channels pass over it.
//   over images
//     Where the output is one pixel an image (fully connected layers) the images take the place of the
//     pixels, and the taps are cut into panels whose weights stay in L1 while 512 images pass; so the
//     weights, which are large, stream from memory once. The sums wait in L2.
//
// All sums of a task's pixels are finished in it: threads share out output values, and the result does not
// depend on their number. docs/engine/tile-units.md tells more.
#pragma once

#include "nn/layers/convolution_call.h"
#include "nn/layers/packed_weights.h"

namespace penumbra::nn {

// The input is in the weights' numbers; output and residual, which is for a step of 1, may be in any.
struct TileConvolution : ConvolutionCall {
  const PackedWeights* weights = nullptr;
  // The output pixels are (row + i step, column + j step); of a transposed convolution, those of one phase.
  int step = 1, row = 0, column = 0;
};

void convolve_on_tiles(const TileConvolution& convolution, Arena& arena);

}  // namespace penumbra::nn
