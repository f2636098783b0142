// The two loop nests around the register tile (nn/simd/kernel_table.h) that compute a convolution directly.
//
//   over pixels
//     A task is a patch of output pixels, small enough for its input to stay in L2 while all tiles of output
//     channels pass over it; the weights of a tile stay there while the patch passes.
//   over images
//     Where the output is one pixel an image (fully connected layers) the images take the place of the
//     pixels, and the taps are cut into panels whose weights stay in L2 while 8 tiles of images pass; so the
//     weights, which are large, stream from memory seldom.
//
// Threads share out tasks of output values, never sums: the result does not depend on their number.
// docs/engine/fast-convolution.md tells how this came about.
#pragma once

#include <cstddef>
#include <span>

#include "nn/layers/convolution_call.h"
#include "nn/layers/packed_weights.h"

namespace penumbra::nn {

struct DirectConvolution : ConvolutionCall {
  std::span<const PackedWeights> groups = {};  // one a group of channels, of equal shapes
  const std::byte* values = nullptr;           // the input's, all of them, in the weights' precision
};

void convolve_pixels(const DirectConvolution& convolution);

// One group; output without a border.
void convolve_images(const DirectConvolution& convolution);

}  // namespace penumbra::nn
