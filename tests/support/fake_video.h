// Cameras that are not there: the answers of V4L2 drivers, as they were seen of USB cameras, in place of the
// kernel's.
#pragma once

#include <linux/videodev2.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "slam/sources/live/video_calls.h"

namespace penumbra::test {

struct FakeFormat {
  std::uint32_t code = V4L2_PIX_FMT_YUYV;
  std::uint32_t width = 0, height = 0;
  std::uint32_t padding = 0;  // bytes at the end of each line
  std::uint32_t rate = 30;    // Hz
};

struct FakeCamera {
  std::vector<FakeFormat> formats;
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  bool is_busy = false;
  bool is_there = true;
  std::uint32_t quantization = V4L2_QUANTIZATION_LIM_RANGE, colorspace = V4L2_COLORSPACE_SRGB;

  struct Frame {
    double time = 0.0;  // seconds on the monotonic clock
    std::string bytes;
    bool damaged = false;
  };
  std::deque<Frame> frames;  // that come next

  // What it was set to.
  FakeFormat chosen;
  bool streams = false;
  int opened = 0;
};

class FakeVideo final : public slam::VideoCalls {
 public:
  FakeCamera& add(const std::string& path) { return cameras_[path]; }
  int mapped() const { return mapped_; }  // pieces of memory that are
  int open_devices() const { return static_cast<int>(devices_.size()); }

  int open(const char* path) override {
    const auto found = cameras_.find(path);
    if (found == cameras_.end() || !found->second.is_there) return fail(ENOENT);
    ++found->second.opened;
    devices_[next_] = {&found->second, {}, {}};
    return next_++;
  }
  void close(int descriptor) override { devices_.erase(descriptor); }
  void* map(int descriptor, std::size_t bytes, off_t offset) override {
    Device& device = devices_.at(descriptor);
    device.memory[static_cast<std::uint32_t>(offset / kPage)] = std::make_unique<char[]>(bytes);
    ++mapped_;
    return device.memory[static_cast<std::uint32_t>(offset / kPage)].get();
  }
  void unmap(void*, std::size_t) override { --mapped_; }
  bool wait(int descriptor, int milliseconds) override {
    const Device& device = devices_.at(descriptor);
    if (!device.camera->is_there || !device.camera->frames.empty()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    return false;
  }
  int control(int descriptor, unsigned long request, void* argument) override {
    Device& device = devices_.at(descriptor);
    FakeCamera& camera = *device.camera;
    if (!camera.is_there) return fail(ENODEV);
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& answer = *static_cast<v4l2_capability*>(argument);
        std::memcpy(answer.card, "Fake camera", 12);
        answer.capabilities = camera.capabilities | V4L2_CAP_DEVICE_CAPS;
        answer.device_caps = camera.capabilities;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto& answer = *static_cast<v4l2_fmtdesc*>(argument);
        std::vector<std::uint32_t> codes;
        for (const FakeFormat& format : camera.formats) {
          if (codes.empty() || codes.back() != format.code) codes.push_back(format.code);
        }
        if (answer.index >= codes.size()) return fail(EINVAL);
        answer.pixelformat = codes[answer.index];
        return 0;
      }
      case VIDIOC_ENUM_FRAMESIZES: {
        auto& answer = *static_cast<v4l2_frmsizeenum*>(argument);
        std::uint32_t index = 0;
        for (const FakeFormat& format : camera.formats) {
          if (format.code != answer.pixel_format || index++ != answer.index) continue;
          answer.type = V4L2_FRMSIZE_TYPE_DISCRETE;
          answer.discrete = {format.width, format.height};
          return 0;
        }
        return fail(EINVAL);
      }
      case VIDIOC_G_FMT:
        tell(camera, camera.formats.front(), *static_cast<v4l2_format*>(argument));
        return 0;
      case VIDIOC_S_FMT: {
        auto& asked = *static_cast<v4l2_format*>(argument);
        if (camera.is_busy) return fail(EBUSY);
        // As drivers do: the nearest that there is, whatever was asked for.
        camera.chosen = camera.formats.front();
        for (const FakeFormat& format : camera.formats) {
          if (format.code == asked.fmt.pix.pixelformat &&
              (camera.chosen.code != format.code || format.width == asked.fmt.pix.width))
            camera.chosen = format;
        }
        tell(camera, camera.chosen, asked);
        return 0;
      }
      case VIDIOC_S_PARM:
        static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, camera.chosen.rate};
        return 0;
      case VIDIOC_REQBUFS:
        static_cast<v4l2_requestbuffers*>(argument)->count = 3;  // fewer than asked for
        return 0;
      case VIDIOC_QUERYBUF: {
        auto& answer = *static_cast<v4l2_buffer*>(argument);
        answer.length = 1U << 20U;
        answer.m.offset = answer.index * kPage;
        return 0;
      }
      case VIDIOC_QBUF:
        device.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_STREAMON:
        camera.streams = true;
        return 0;
      case VIDIOC_STREAMOFF:
        camera.streams = false;
        return 0;
      case VIDIOC_DQBUF: {
        if (camera.frames.empty() || device.queued.empty()) return fail(EAGAIN);
        auto& answer = *static_cast<v4l2_buffer*>(argument);
        const FakeCamera::Frame frame = std::move(camera.frames.front());
        camera.frames.pop_front();
        answer.index = device.queued.front();
        device.queued.pop_front();
        answer.bytesused = static_cast<__u32>(frame.bytes.size());
        answer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (frame.damaged ? V4L2_BUF_FLAG_ERROR : 0U);
        answer.timestamp.tv_sec = static_cast<time_t>(frame.time);
        answer.timestamp.tv_usec =
            static_cast<suseconds_t>(1e6 * (frame.time - static_cast<double>(answer.timestamp.tv_sec)));
        std::memcpy(device.memory.at(answer.index).get(), frame.bytes.data(), frame.bytes.size());
        return 0;
      }
      default:
        return fail(ENOTTY);
    }
  }

 private:
  static constexpr std::uint32_t kPage = 1U << 12U;
  struct Device {
    FakeCamera* camera = nullptr;
    std::deque<std::uint32_t> queued;
    std::map<std::uint32_t, std::unique_ptr<char[]>> memory;
  };
  static int fail(int error) {
    errno = error;
    return -1;
  }
  static void tell(const FakeCamera& camera, const FakeFormat& format, v4l2_format& answer) {
    v4l2_pix_format& pix = answer.fmt.pix;
    pix.width = format.width;
    pix.height = format.height;
    pix.pixelformat = format.code;
    pix.field = V4L2_FIELD_NONE;
    pix.quantization = camera.quantization;
    pix.colorspace = camera.colorspace;
    const std::uint32_t pixel = format.code == V4L2_PIX_FMT_GREY ? 1U : 2U;
    pix.bytesperline = format.code == V4L2_PIX_FMT_MJPEG ? 0U : pixel * format.width + format.padding;
  }

  std::map<std::string, FakeCamera> cameras_;
  std::map<int, Device> devices_;
  int next_ = 100, mapped_ = 0;
};

}  // namespace penumbra::test
