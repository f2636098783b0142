// Frames from a stream of bytes.
//
// YUV4MPEG2, as `ffmpeg -f yuv4mpegpipe` writes it: both images in one, side by side or one above the other.
//
//   YUV4MPEG2 W1504 H480 F20:1 Ip A1:1 C420jpeg\n        header; C mono, 420 (any), 422, 444, of 8 bits
//   FRAME\n                                              then Y, and U and V unless mono
//
// Colour: nn/image/yuv.h, in full range where the header says so (XCOLORRANGE=FULL, or else C420jpeg and
// mono).
//
// RGB-D, a form of our own for cameras that have depth:
//
//   PENUMBRA-RGBD W640 H480\n
//   FRAME 1403636579763555584\n                          nanoseconds; then 3 W H bytes BGR, 2 W H of depth,
//                                                        little-endian levels
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/geometry/sensor.h"
#include "slam/sources/live/byte_input.h"

namespace penumbra::slam {

enum class StereoLayout { side_by_side, top_bottom };  // the left image is on the left, or above

// A frame as it came, its pixels not yet taken apart.
struct StreamFrame {
  int index = 0;           // of the stream, from 0 on
  double timestamp = 0.0;  // seconds
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> right;  // the right camera's, where two cameras sent it
};

class FrameStream {
 public:
  virtual ~FrameStream() = default;
  virtual std::string name() const = 0;  // for messages
  // Ends all waiting, from any thread: read() then ends as if the stream had.
  virtual void stop() = 0;
  // Whether frames tell when they were taken; or else how many there are a second.
  virtual bool has_times() const = 0;
  virtual Sensor sensor() const = 0;
  virtual Size size() const = 0;  // of one image
  // The next frame into `frame`, whose memory is used again; false at the end. A frame that is cut off by the
  // end is none. Throws InputError naming the byte for what is no frame.
  virtual bool read(StreamFrame& frame) = 0;
  // The images of a frame: left (or colour) and right; or colour and depth as levels. `colour`: BGR, else
  // grey.
  virtual void images(const StreamFrame& frame, bool colour, ByteImage& left, ByteImage& right,
                      WordImage& depth) const = 0;
  // What was odd about the frames so far, from any thread; empty: nothing.
  virtual std::string remark() const { return {}; }
};

// By its first bytes. `rate`: Hz, in place of the header's. Throws InputError for a stream that is neither,
// and for one without a rate.
std::unique_ptr<FrameStream> open_frame_stream(ByteInput& input, StereoLayout layout,
                                               std::optional<double> rate);

}  // namespace penumbra::slam
