// The images within a camera's frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "nn/image/image.h"
#include "slam/sources/live/video_format.h"

namespace penumbra::slam {

// A frame's bytes as an image, grey, or blue, green and red where `colour` and the camera has it. GREY, YUYV
// and UYVY: what VideoDevice::take has checked; colours by nn/image/yuv.h. MJPG: a JPEG, whose Huffman tables
// may be missing, as USB cameras' are; throws InputError naming `place` where it is damaged.
ByteImage image_of_video(const VideoFormat& format, std::span<const std::uint8_t> bytes, bool colour,
                         const std::string& place);

}  // namespace penumbra::slam
