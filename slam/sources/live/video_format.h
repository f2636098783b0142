// What a V4L2 camera is asked for, and what it gives: pixels that are read, of the size that the calibration
// is for, at the rate that is wanted.
//
//   GREY   brightness                                 Penumbra's own food
//   YUYV, UYVY   brightness of each pixel, colour of two
//   MJPG   a JPEG each; many USB cameras have their full rate in it alone, and JPEG's blocks cost some
//          features
//
// Of those that the camera offers in that size, the first in this order that reaches the rate, or else the
// fastest.
//
// Source: Linux Media Infrastructure userspace API, part I (VIDIOC_ENUM_FMT, VIDIOC_S_FMT, VIDIOC_S_PARM).
#pragma once

#include <cstdint>
#include <string>

#include "nn/image/image.h"
#include "slam/sources/live/video_calls.h"

namespace penumbra::slam {

enum class VideoPixels { grey, yuyv, uyvy, mjpg };
const char* name_of(VideoPixels pixels);
constexpr std::size_t bytes_per_pixel(VideoPixels pixels) {  // none of MJPG
  return pixels == VideoPixels::mjpg ? 0 : pixels == VideoPixels::grey ? 1 : 2;
}

inline constexpr double kUsualVideoRate = 30.0;  // Hz, where nothing else is asked for

struct VideoRequest {
  Size size = {};     // of a whole frame; 0: as the camera stands
  double rate = 0.0;  // Hz; 0: kUsualVideoRate
};

struct VideoFormat {
  VideoPixels pixels = VideoPixels::grey;
  Size size = {};
  std::size_t bytes_per_line = 0;  // none of MJPG
  bool full_range = false;  // brightness from 0 to 255 instead of 16 to 235: as the driver says, or JPEG's
  double rate = 0.0;        // Hz; 0 where the driver does not say
};

// Sets the camera up. Throws InputError naming `device`, what was expected and what it offers where it is no
// camera that streams, or has no such size or pixels; Error where the driver fails.
VideoFormat negotiate_format(VideoCalls& calls, int descriptor, const std::string& device,
                             const VideoRequest& request);

}  // namespace penumbra::slam
