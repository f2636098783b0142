#include "slam/sources/live/video_stream.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "slam/sources/live/video_pixels.h"

namespace penumbra::slam {

namespace {

constexpr int kPatience = 100;  // milliseconds until it is looked whether to stop

// Of the camera's frames, for images of `one`.
Size frame_size(const VideoStreamOptions& options) {
  Size size = options.size;
  if (!options.right.empty()) return size;
  (options.layout == StereoLayout::side_by_side ? size.width : size.height) *= 2;
  return size;
}

}  // namespace

VideoStream::VideoStream(const VideoStreamOptions& options, VideoCalls& calls) : layout_(options.layout) {
  const VideoRequest request{frame_size(options), options.rate};
  for (const std::string& path : {options.left, options.right}) {
    if (path.empty()) continue;
    cameras_.emplace_back();
    cameras_.back().device = std::make_unique<VideoDevice>(path, request, calls);
  }
  size_ = cameras_.front().device->format().size;
  double rate = options.rate > 0.0 ? options.rate : kUsualVideoRate;
  for (const Camera& camera : cameras_) {
    const VideoFormat& format = camera.device->format();
    if (format.rate > 0.0) rate = std::min(rate, format.rate);
    if (format.size != size_) {
      throw InputError(camera.device->path(),
                       fmt::format("images of {}x{} pixels as of {}", size_.width, size_.height,
                                   cameras_.front().device->path()),
                       fmt::format("{}x{}", format.size.width, format.size.height));
    }
  }
  half_period_ = 0.5 / rate;
  if (cameras_.size() > 1) return;
  int& side = layout_ == StereoLayout::side_by_side ? size_.width : size_.height;
  if (side % 2 != 0)
    throw InputError(options.left, "an even number of pixels where two images lie side by side",
                     fmt::format("{}", side));
  side /= 2;
}

std::string VideoStream::name() const {
  std::string text = cameras_.front().device->path();
  if (cameras_.size() > 1) text += " and " + cameras_.back().device->path();
  return text;
}

std::string VideoStream::description() const {
  std::string text;
  for (const Camera& camera : cameras_) {
    const VideoFormat& format = camera.device->format();
    text += fmt::format("{}{}: {}x{} {}, {}", text.empty() ? "" : "; ", camera.device->path(),
                        format.size.width, format.size.height, name_of(format.pixels),
                        format.rate > 0.0 ? fmt::format("{:g} Hz", format.rate) : "rate not said");
  }
  return text;
}

// Waits until the camera has a frame; false where it is to stop, or has none for now.
bool VideoStream::fill(Camera& camera) {
  if (!camera.has_frame) camera.has_frame = camera.device->take(kPatience, camera.frame);
  return camera.has_frame;
}

// Whether the frames of both cameras belong together; the older one has no partner otherwise.
bool VideoStream::pair_up() {
  if (cameras_.size() == 1) return true;
  Camera& left = cameras_.front();
  Camera& right = cameras_.back();
  const std::lock_guard lock(mutex_);
  const double apart = left.frame.timestamp - right.frame.timestamp;
  if (std::abs(apart) > half_period_) {
    (apart < 0.0 ? left : right).has_frame = false;
    ++alone_;
    return false;
  }
  ++pairs_;
  apart_ += std::abs(apart);
  farthest_apart_ = std::max(farthest_apart_, std::abs(apart));
  return true;
}

bool VideoStream::read(StreamFrame& frame) {
  while (!stopped_) {
    if (!std::all_of(cameras_.begin(), cameras_.end(), [&](Camera& camera) { return fill(camera); }) ||
        !pair_up())
      continue;
    frame.index = count_++;
    frame.timestamp = cameras_.front().frame.timestamp;
    std::swap(frame.bytes, cameras_.front().frame.bytes);
    if (cameras_.size() > 1) std::swap(frame.right, cameras_.back().frame.bytes);
    for (Camera& camera : cameras_) camera.has_frame = false;
    return true;
  }
  return false;
}

void VideoStream::images(const StreamFrame& frame, bool colour, ByteImage& left, ByteImage& right,
                         WordImage&) const {
  const auto image_of = [&](const Camera& camera, const std::vector<std::uint8_t>& bytes) {
    const VideoFormat& format = camera.device->format();
    ByteImage image = image_of_video(format, bytes, colour, camera.device->path());
    if (image.size() != format.size) {
      throw InputError(camera.device->path(),
                       fmt::format("a JPEG of {}x{}", format.size.width, format.size.height),
                       fmt::format("{}x{}", image.width(), image.height()));
    }
    return image;
  };
  if (cameras_.size() > 1) {
    left = image_of(cameras_.front(), frame.bytes);
    right = image_of(cameras_.back(), frame.right);
    return;
  }
  const ByteImage both = image_of(cameras_.front(), frame.bytes);
  const bool beside = layout_ == StereoLayout::side_by_side;
  left = ByteImage::copy_of(both.region({0, 0, size_.width, size_.height}));
  right = ByteImage::copy_of(
      both.region({beside ? size_.width : 0, beside ? 0 : size_.height, size_.width, size_.height}));
}

std::string VideoStream::remark() const {
  std::string text;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  const std::lock_guard lock(mutex_);
  if (pairs_ > 0) {
    add(fmt::format("images of a pair were {:.1f} ms apart at the mean, {:.1f} ms at most, {} had no partner",
                    1e3 * apart_ / pairs_, 1e3 * farthest_apart_, alone_));
  }
  for (const Camera& camera : cameras_) {
    const VideoDevice& device = *camera.device;
    if (device.lost() > 0) add(fmt::format("{} was gone {}", device.path(), counted(device.lost(), "time")));
    if (device.damaged() > 0)
      add(fmt::format("damaged: {} of {}", counted(device.damaged(), "frame"), device.path()));
  }
  return text;
}

}  // namespace penumbra::slam
