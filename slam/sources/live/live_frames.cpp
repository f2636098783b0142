#include "slam/sources/live/live_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "nn/base/error.h"
#include "nn/image/levels.h"

namespace penumbra::slam {

namespace {

// The camera, if the stream's images are its.
const CameraFile& checked(const CameraFile& camera, const FrameStream& stream) {
  if (camera.sensor != stream.sensor()) {
    const auto text = [](Sensor sensor) {
      return sensor == Sensor::rgbd ? "a camera with depth" : "two cameras";
    };
    throw InputError(stream.name(), fmt::format("frames of {}, as in the calibration", text(camera.sensor)),
                     text(stream.sensor()));
  }
  const Size size = stream.size();
  if (camera.left.width != size.width || camera.left.height != size.height) {
    throw InputError(
        stream.name(),
        fmt::format("images of {} x {} pixels, as in the calibration", camera.left.width, camera.left.height),
        fmt::format("{} x {} (--layout says how two lie in one)", size.width, size.height));
  }
  return camera;
}

}  // namespace

LiveFrames::LiveFrames(FrameStream& stream, const CameraFile& camera, const LiveSettings& settings)
    : stream_(stream),
      settings_(settings),
      depth_factor_(camera.depth_factor),
      camera_(make_camera(checked(camera, stream))),
      thread_([this] { run(); }) {}

LiveFrames::~LiveFrames() {
  stream_.stop();
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveFrames::run() {
  try {
    for (bool is_first = true; stream_.read(reading_.frame); is_first = false) {
      const Clock::time_point now = Clock::now();
      std::unique_lock lock(mutex_);
      if (is_first) {
        first_read_ = now;
        first_timestamp_ = reading_.frame.timestamp;
      } else {
        keep_time(now);
      }
      reading_.read = last_read_ = now;
      reading_.frame.timestamp += late_;
      ++counts_.read;
      if (settings_.drops) {
        counts_.dropped += is_waiting_ ? 1 : 0;
      } else {
        changed_.wait(lock, [&] { return !is_waiting_ || stopped_; });
      }
      if (stopped_) break;
      std::swap(reading_, waiting_);
      is_waiting_ = true;
      changed_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

// How late the frame is that has just come, after how long a silence. What comes late because it was held up
// comes in a burst; then the time that was lost is given back.
void LiveFrames::keep_time(Clock::time_point now) {
  constexpr double kSilence = 1.0;  // seconds
  const double silence = std::chrono::duration<double>(now - last_read_).count();
  counts_.longest_silence = std::max(counts_.longest_silence, silence);
  if (!settings_.drops || stream_.has_times()) return;
  const double lag =
      std::chrono::duration<double>(now - first_read_).count() - reading_.frame.timestamp + first_timestamp_;
  late_ = silence > kSilence ? std::max(late_, lag) : std::clamp(lag, 0.0, late_);
}

FrameSource::Next LiveFrames::wait(double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return is_waiting_ || ended_; });
  if (is_waiting_) return Next::frame;
  if (!ended_) return Next::later;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return Next::end;
}

StereoImages LiveFrames::next() {
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting_, taken_);
    is_waiting_ = false;
    const double delay = std::chrono::duration<double>(Clock::now() - taken_.read).count();
    counts_.longest_delay = std::max(counts_.longest_delay, delay);
    delays_ += delay;
    ++taken_count_;
  }
  changed_.notify_all();
  const auto scope = timer_.measure("taking_apart");
  newest_ = {taken_.frame.index, taken_.frame.timestamp};
  StereoImages images;
  images.index = taken_.frame.index;
  images.timestamp = taken_.frame.timestamp;
  WordImage depth;
  stream_.images(taken_.frame, settings_.colour, images.left, images.right, depth);
  images.left = camera_.left.linear(std::move(images.left));
  if (stream_.sensor() == Sensor::stereo) {
    images.right = camera_.right.linear(std::move(images.right));
  } else {
    images.depth = camera_.left.nearest(metres_of(depth, depth_factor_));
  }
  return images;
}

StageTimer LiveFrames::take_times() { return timer_.take(); }

LiveCounts LiveFrames::counts() const {
  const std::lock_guard lock(mutex_);
  LiveCounts counts = counts_;
  counts.mean_delay = taken_count_ > 0 ? delays_ / taken_count_ : 0.0;
  return counts;
}

}  // namespace penumbra::slam
