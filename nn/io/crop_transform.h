// From an image file's pixels to a classifier's input, as torchvision's ImageNet presets do it.
//
//   the shorter side is resized to `resize` pixels (antialiased), the longer one to floor(resize long /
//   short); of that the central crop x crop pixels;  x = (rgb / 255 - mean) / std
//
// Source: torchvision.transforms.Resize(256), CenterCrop(224), ToTensor, Normalize.
#pragma once

#include <array>

#include "nn/image/image.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct CropTransform {
  int resize = 256;                                   // pixels of the shorter side
  int crop = 224;                                     // pixels, at most `resize`
  std::array<float, 3> mean{0.485F, 0.456F, 0.406F};  // of red, green, blue in 0..1
  std::array<float, 3> standard_deviation{0.229F, 0.224F, 0.225F};
};

// `image` is 8-bit grey or BGR, not empty. The map is [1, 3, crop, crop] in blocks of 4.
FeatureMap transform_image(const ByteView& image, const CropTransform& transform, Arena& arena, int border);

}  // namespace penumbra::nn
