// Images of cameras that give the brightness of every pixel and the colour of two pixels together.
//
//   blue  = y                   + 2.018 (U - 128)
//   green = y - 0.813 (V - 128) - 0.391 (U - 128)       y = 1.164 (Y - 16), at least 0
//   red   = y + 1.596 (V - 128)                         ITU-R BT.601, as USB cameras mean it
//
// Error against real arithmetic: 1 level. Cost: about 2 ns a pixel.
#pragma once

#include "nn/image/image.h"

namespace penumbra {

// The bytes of two pixels: U Y V Y (ROS: yuv422, uyvy) or Y U Y V (yuv422_yuy2, yuyv).
enum class Yuv422Order { uyvy, yuyv };

// `pairs`: 2 channels, of an even width. Brightness alone, as it is; or blue, green, red.
ByteImage grey_of_yuv422(const ByteView& pairs, Yuv422Order order);
ByteImage bgr_of_yuv422(const ByteView& pairs, Yuv422Order order);

}  // namespace penumbra
