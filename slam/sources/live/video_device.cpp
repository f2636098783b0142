#include "slam/sources/live/video_device.h"

#include <fmt/core.h>
#include <linux/videodev2.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr auto kSilence = std::chrono::seconds(2);  // after which a camera is set up anew
constexpr auto kBetweenTries = std::chrono::milliseconds(500);

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string why_not_opened(const std::string& path, int error) {
  const char* hint = "";
  if (error == EACCES) hint = " (is the user in the group video?)";
  if (error == EBUSY) hint = " (another program uses it)";
  return fmt::format("{}: cannot be opened: {}{}", path, std::strerror(error), hint);
}

}  // namespace

VideoDevice::VideoDevice(std::string path, const VideoRequest& request, VideoCalls& calls)
    : path_(std::move(path)), request_(request), calls_(calls) {
  try {
    format_ = open();
  } catch (...) {
    close();
    throw;
  }
  request_.size = format_.size;  // whatever it stands at when it comes back
}

VideoDevice::~VideoDevice() { close(); }

VideoFormat VideoDevice::open() {
  descriptor_ = calls_.open(path_.c_str());
  if (descriptor_ < 0) throw Error(why_not_opened(path_, errno));
  const VideoFormat format = negotiate_format(calls_, descriptor_, path_, request_);
  start();
  return format;
}

void VideoDevice::start() {
  const auto require = [&](bool fine, const char* what) {
    if (!fine) throw Error(fmt::format("{}: {}: {}", path_, what, std::strerror(errno)));
  };
  v4l2_requestbuffers wanted{};
  wanted.count = kBuffers;
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = V4L2_MEMORY_MMAP;
  require(calls_.control(descriptor_, VIDIOC_REQBUFS, &wanted) == 0 && wanted.count > 0,
          "shares no memory for frames");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = wanted.type;
    buffer.memory = wanted.memory;
    require(calls_.control(descriptor_, VIDIOC_QUERYBUF, &buffer) == 0, "shares no memory for frames");
    void* const memory = calls_.map(descriptor_, buffer.length, static_cast<off_t>(buffer.m.offset));
    require(memory != nullptr, "shares no memory for frames");
    buffers_.push_back({memory, buffer.length});
    require(calls_.control(descriptor_, VIDIOC_QBUF, &buffer) == 0, "takes no memory for frames");
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  require(calls_.control(descriptor_, VIDIOC_STREAMON, &type) == 0, "does not stream");
  since_1970_ = seconds_of(CLOCK_REALTIME) - seconds_of(CLOCK_MONOTONIC);
  last_frame_ = Clock::now();
}

void VideoDevice::close() {
  if (descriptor_ < 0) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  calls_.control(descriptor_, VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_) calls_.unmap(buffer.memory, buffer.bytes);
  buffers_.clear();
  calls_.close(descriptor_);
  descriptor_ = -1;
}

void VideoDevice::lose() {
  close();
  ++lost_;
  last_try_ = Clock::now();
}

// Whether the camera that was lost is there again. What keeps it from being opened may pass.
bool VideoDevice::come_back() {
  if (Clock::now() - last_try_ < kBetweenTries) return false;
  last_try_ = Clock::now();
  VideoFormat now;
  try {
    now = open();
  } catch (const InputError&) {
    close();
    throw;
  } catch (const Error&) {
    close();
    return false;
  }
  if (now.pixels != format_.pixels || now.bytes_per_line != format_.bytes_per_line ||
      now.full_range != format_.full_range) {
    throw InputError(path_, fmt::format("{} as before the camera was gone", name_of(format_.pixels)),
                     now.pixels != format_.pixels ? name_of(now.pixels) : "other lines or another range");
  }
  return true;
}

bool VideoDevice::is_whole(std::size_t bytes) const {
  if (format_.pixels == VideoPixels::mjpg) return bytes > 0;
  // The last line may lack what pads it.
  return bytes >= format_.bytes_per_line * static_cast<std::size_t>(format_.size.height - 1) +
                      bytes_per_pixel(format_.pixels) * static_cast<std::size_t>(format_.size.width);
}

bool VideoDevice::take(int milliseconds, VideoFrame& frame) {
  if (descriptor_ < 0 && !come_back()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    return false;
  }
  if (!calls_.wait(descriptor_, milliseconds)) {
    if (Clock::now() - last_frame_ > kSilence) lose();
    return false;
  }
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (calls_.control(descriptor_, VIDIOC_DQBUF, &buffer) != 0) {
    if (errno != EAGAIN) lose();  // ENODEV: it was unplugged; EIO: it has hung up
    return false;
  }
  if (buffer.index >= buffers_.size())
    throw Error(fmt::format("{}: gives memory that it does not have", path_));
  last_frame_ = Clock::now();
  const std::size_t bytes = std::min<std::size_t>(buffer.bytesused, buffers_[buffer.index].bytes);
  const bool good = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && is_whole(bytes);
  if (good) {
    const auto* const from = static_cast<const std::uint8_t*>(buffers_[buffer.index].memory);
    frame.bytes.assign(from, from + bytes);
    frame.timestamp =
        static_cast<double>(buffer.timestamp.tv_sec) + 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
    const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    if (monotonic) frame.timestamp += since_1970_;
  } else {
    ++damaged_;
  }
  if (calls_.control(descriptor_, VIDIOC_QBUF, &buffer) != 0) lose();
  return good;
}

}  // namespace penumbra::slam
