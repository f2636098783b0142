// A camera by V4L2, the kernel's interface: its frames in memory that is shared with the driver.
//
//   VideoDevice camera("/dev/video0", {.size = {1344, 376}, .rate = 30.0}, system_video_calls());
//   VideoFrame frame;
//   while (running) if (camera.take(100, frame)) use(frame);
//
// A camera that is unplugged, or falls asleep, is opened again as soon as it is there, with what it had been
// asked for; until then take() finds no frame.
//
// Source: Linux Media Infrastructure userspace API, part I, "Streaming I/O (Memory Mapping)".
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slam/sources/live/video_calls.h"
#include "slam/sources/live/video_format.h"

namespace penumbra::slam {

struct VideoFrame {
  // Seconds since 1970, of its first bytes' arrival or of the exposure, as the driver has it.
  double timestamp = 0.0;
  std::vector<std::uint8_t> bytes;
};

class VideoDevice {
 public:
  // Throws as negotiate_format does, and Error where the device cannot be opened or does not stream.
  VideoDevice(std::string path, const VideoRequest& request, VideoCalls& calls);
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  const std::string& path() const { return path_; }
  const VideoFormat& format() const { return format_; }
  // The oldest frame that waits, into `frame`, whose memory is used again; false where none comes within so
  // many milliseconds. Frames that the driver marks as damaged, and those that are too short, are left out.
  // Throws InputError where the camera comes back and has another format.
  bool take(int milliseconds, VideoFrame& frame);
  // From any thread: frames so far, and how often the camera was gone.
  int damaged() const { return damaged_; }
  int lost() const { return lost_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Buffer {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };
  VideoFormat open();  // returns what the camera now gives
  void start();
  void close();
  void lose();
  bool come_back();
  bool is_whole(std::size_t bytes) const;

  const std::string path_;
  VideoRequest request_;
  VideoCalls& calls_;
  VideoFormat format_;
  int descriptor_ = -1;
  std::vector<Buffer> buffers_;
  double since_1970_ = 0.0;  // what is added to the monotonic clock
  std::atomic<int> damaged_{0}, lost_{0};
  Clock::time_point last_frame_, last_try_;
};

}  // namespace penumbra::slam
