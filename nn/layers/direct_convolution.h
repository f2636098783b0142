// The two loop nests around the register tile (nn/simd/kernel_table.h) that compute a convolution directly.
//
//   over pixels   a task is a patch of output pixels, small enough for its input to stay in L2 while all
//   tiles
//                 of output channels pass over it; the weights of a tile stay there while the patch passes
//   over images   where the output is one pixel an image (fully connected layers): the images take the place
//                 of the pixels, and the taps are cut into panels whose weights stay in L2 while 8 tiles of
//                 images pass; so the weights, which are large, stream from memory seldom
//
// Threads share out tasks of output values, never sums: the result does not depend on their number.
// docs/engine/fast-convolution.md tells how this came about.
#pragma once

#include <cstddef>
#include <span>

#include "nn/layers/activations.h"
#include "nn/layers/packed_weights.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct DirectConvolution {
  std::span<const PackedWeights> groups;  // one a group of channels, of equal shapes
  const std::ptrdiff_t* taps = nullptr;   // of a group, from its first block's pixel on
  int stride = 1, padding = 0;
  Activation activation = Activation::none;
  float slope = kDefaultSlope;
  const FeatureMap* input = nullptr;
  const std::byte* values = nullptr;  // the input's, all of them, in the weights' precision
  const FeatureMap* residual = nullptr;
  FeatureMap* output = nullptr;
};

void convolve_pixels(const DirectConvolution& convolution);

// One group; output without a border.
void convolve_images(const DirectConvolution& convolution);

}  // namespace penumbra::nn
