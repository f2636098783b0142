// Resizing 8-bit images with a triangle filter that widens with the reduction: no aliasing, unlike the
// four-pixel bilinear interpolation of nn/io/image_transform.h.
//
//   y(i) = sum_j w(i, j) x(j) / sum_j w(i, j),   w(i, j) = max(0, 1 - |j + 1/2 - (i + 1/2) s| / max(s, 1)),
//   s = extent of x / extent of y
//
// first along the rows, then along the columns, rounded to 8 bits after each; weights are whole numbers of
// 2^-22. Every pixel equals that of Pillow's Image.resize(..., BILINEAR), which torchvision's Resize uses for
// images. Cost: 2 max(s, 1) multiply-adds a pixel and direction.
// Source: Pillow 9.4, "Resample" filters; reproduced from its documented arithmetic.
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

// The part `window` of `image` (8-bit, 1 or 3 channels, not empty) resized to `size`; only that part is
// computed. `window` must lie inside `size`, which must not be empty. Bytes lie row by row,
// channel beside channel.
ArenaVector<std::uint8_t> antialiased_resize(const ByteView& image, const Size& size, const Rect& window,
                                             Arena& arena);

}  // namespace penumbra::nn
