// An instance's mask as a weighted sum of prototype masks, cut out of the image by the instance's box.
//
//   q(i, j) = sigmoid( sum_k w_k P_k(i, j) )      probability at a prototype's pixel
//   m(x, y) = q at (s_y (y + 1/2) + t - 1/2, s_x (x + 1/2) + l - 1/2) > threshold,
//   for pixels (x, y) of the box
//
// q is interpolated bilinearly, its edge pixels repeated outside. (s_x, s_y) are prototype pixels per image
// pixel, (l, t) is the image's upper left corner on the prototypes, in their pixels. A pixel belongs to the
// box where x1 <= x < x2 and y1 <= y < y2 hold for its whole-numbered coordinates. Shapes: P [1, K, H, W], K
// weights. Cost: K multiply-adds a prototype pixel under the box, one bilinear sample an image pixel of it.
// Source: Bolya et al. 2019, YOLACT, section 3; Jocher et al., YOLOv5 7.0.
#pragma once

#include <span>

#include "nn/layers/box.h"
#include "nn/layers/mask_paste.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// Where the image lies on the prototypes.
struct PrototypeFrame {
  float left = 0.0F, top = 0.0F;           // prototype pixels
  float scale_x = 0.25F, scale_y = 0.25F;  // prototype pixels per image pixel
};

// `box` is in pixels of the image and lies inside it. `scratch` is overwritten, a number for each prototype
// pixel; `mask` too, its memory used again.
void prototype_mask(const FeatureMap& prototypes, std::span<const float> weights, const PrototypeFrame& frame,
                    const Box& box, int image_width, int image_height, float threshold,
                    std::span<float> scratch, Mask& mask);

}  // namespace penumbra::nn
