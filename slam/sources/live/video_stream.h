// Pairs of images from cameras by V4L2: one whose frames hold both, or two.
//
// Of two cameras, each on its own clock, the images belong together whose times are nearest, within half a
// frame's time; what has no partner is left out. Cameras that are not triggered together are up to that much
// apart: at 30 Hz 17 ms, in which somebody who walks has moved 2 cm. remark() says how much it was.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "slam/sources/live/frame_stream.h"
#include "slam/sources/live/video_device.h"

namespace penumbra::slam {

struct VideoStreamOptions {
  std::string left = {}, right = {};  // devices; `right` empty: one camera whose frames hold both images
  StereoLayout layout = StereoLayout::side_by_side;  // in these
  Size size = {};                                    // of one image; 0: as the cameras stand
  double rate = 0.0;                                 // Hz; 0: 30
};

class VideoStream final : public FrameStream {
 public:
  // Throws as VideoDevice does.
  explicit VideoStream(const VideoStreamOptions& options, VideoCalls& calls = system_video_calls());

  std::string name() const override;
  Sensor sensor() const override { return Sensor::stereo; }
  Size size() const override { return size_; }
  bool has_times() const override { return true; }
  void stop() override { stopped_ = true; }
  // Never at its end: until stop() it waits for a camera that is gone.
  bool read(StreamFrame& frame) override;
  void images(const StreamFrame& frame, bool colour, ByteImage& left, ByteImage& right,
              WordImage& depth) const override;
  std::string remark() const override;
  // What the cameras were set to: "/dev/video0: 1344x376 YUYV, 30 Hz".
  std::string description() const;

 private:
  struct Camera {
    std::unique_ptr<VideoDevice> device;
    VideoFrame frame;  // the newest that was not used
    bool has_frame = false;
  };
  bool fill(Camera& camera);
  bool pair_up();

  const StereoLayout layout_;
  Size size_;
  std::vector<Camera> cameras_;  // one or two
  double half_period_ = 0.0;     // seconds
  std::atomic<bool> stopped_{false};
  int count_ = 0;
  mutable std::mutex mutex_;  // of what remark() tells
  int pairs_ = 0, alone_ = 0;
  double apart_ = 0.0, farthest_apart_ = 0.0;  // seconds: sum, and most
};

}  // namespace penumbra::slam
