// From a mask head's small probability map to a mask on the image.
//
// The M x M map gets a border of one zero pixel, the box grows about its centre by (M + 2) / M, its corners
// are truncated to whole pixels, the map is resized to the box (bilinear, align_corners false) and cut at a
// threshold.
//
// Cost: a linear interpolation a pixel of the box inside the image, and M + 2 a column of it: each row of the
// map is resized along x once and serves all rows of pixels that lie beside it.
// Source: torchvision.models.detection.roi_heads.paste_masks_in_image; reference/mask_paste.cpp is the
// oracle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nn/layers/box.h"

namespace penumbra::nn {

// A binary mask on an image, stored for its own rectangle only; everything outside is 0.
struct Mask {
  int x = 0, y = 0, width = 0, height = 0;  // the rectangle, inside the image
  std::vector<std::uint8_t> bits;           // row-major, 0 or 1

  bool contains(int px, int py) const {
    return px >= x && py >= y && px < x + width && py < y + height &&
           bits[static_cast<std::size_t>(py - y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(px - x)] != 0;
  }
};

// `probabilities` is M x M, row-major; 1 where the resized probability is > threshold. `mask` is overwritten,
// its memory used again.
void paste_mask(std::span<const float> probabilities, int size, const Box& box, int image_width,
                int image_height, float threshold, Mask& mask);
inline Mask paste_mask(std::span<const float> probabilities, int size, const Box& box, int image_width,
                       int image_height, float threshold = 0.5F) {
  Mask mask;
  paste_mask(probabilities, size, box, image_width, image_height, threshold, mask);
  return mask;
}

}  // namespace penumbra::nn
