// Pixels of the caller's, in the forms that cameras and libraries have them.
//
// Nothing is owned: the pixels must stay as they are until the call that was given the view returns. Pixel
// (0, 0) is the upper left one; rows may be padded.
#pragma once

#include <cstddef>

namespace penumbra {

enum class PixelFormat {
  grey8,           // 1 byte a pixel
  bgr8,            // 3 bytes: blue, green, red
  rgb8,            // 3 bytes: red, green, blue
  depth16,         // 16-bit unsigned, in units of Rig::depth_factor; 0 where unknown
  depth32_metres,  // 32-bit float, metres along the optical axis; 0 or NaN where unknown
};

struct ImageRef {
  const void* pixels = nullptr;  // null: no image
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::grey8;
  std::ptrdiff_t row_bytes = 0;  // from one row to the next; 0: rows without a gap
};

}  // namespace penumbra
