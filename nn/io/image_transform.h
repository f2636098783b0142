// From an image file's pixels to the network's input, as torchvision's detection models do it.
//
//   scale  = min( min_size / min(H, W), max_size / max(H, W) )           in f32, quotients as a (1 / b)
//   H' = floor(H scale), W' = floor(W scale)
//   x  = (rgb / 255 - mean) / std, resized to H' x W' (bilinear, align_corners false), padded with zeros at
//        the right and at the bottom to a multiple of `divisor`
//
// Cost: 4 reads of the image a pixel of the output; one pass.
// Source: torchvision.models.detection.transform.GeneralizedRCNNTransform.
#pragma once

#include <array>

#include "nn/image/image.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct ImageTransform {
  int min_size = 800;   // pixels of the shorter side, unless the longer one would pass max_size
  int max_size = 1333;  // pixels
  int divisor = 32;
  std::array<float, 3> mean{0.485F, 0.456F, 0.406F};  // of red, green, blue in 0..1
  std::array<float, 3> standard_deviation{0.229F, 0.224F, 0.225F};
};

// The image inside its padded feature map, pixels of the network's input.
struct ImageExtent {
  int height = 0, width = 0;                // H', W'
  int padded_height = 0, padded_width = 0;  // the map's
};

// Both throw InputError unless `image` is 8-bit grey or BGR and not empty.
ImageExtent transformed_extent(const ByteView& image, const ImageTransform& transform);

// The map [1, 3, H_padded, W_padded] in blocks of 4; `border` is its zero border.
FeatureMap transform_image(const ByteView& image, const ImageTransform& transform, Arena& arena, int border);

}  // namespace penumbra::nn
