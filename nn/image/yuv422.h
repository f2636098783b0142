// Images of cameras that give the brightness of every pixel and the colour of two pixels together.
#pragma once

#include "nn/image/image.h"
#include "nn/image/yuv.h"

namespace penumbra {

// The bytes of two pixels: U Y V Y (ROS: yuv422, uyvy) or Y U Y V (yuv422_yuy2, yuyv).
enum class Yuv422Order { uyvy, yuyv };

// `pairs`: 2 channels, of an even width. Brightness alone, as it is; or blue, green, red (yuv.h).
ByteImage grey_of_yuv422(const ByteView& pairs, Yuv422Order order);
ByteImage bgr_of_yuv422(const ByteView& pairs, Yuv422Order order, const YuvRange& range = kVideoRange);

}  // namespace penumbra
