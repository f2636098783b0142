// Frames as a stream brings them. A thread reads on while the one before is worked on; where frames come
// faster than they are taken, the newest wins and those before it are dropped, so that what is taken is never
// older than the frame that comes while one is worked on. Or the stream waits until a frame is taken.
//
// A stream without times of its own counts frames; where a live one falls silent for longer than a second and
// comes back, the frames that follow are as much later.
//
// No frame is copied: three buffers go round between the thread and whoever takes the frames.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "slam/sources/calibration/camera_file.h"
#include "slam/sources/frame_source.h"
#include "slam/sources/live/frame_stream.h"

namespace penumbra::slam {

struct LiveSettings {
  bool drops = true;    // frames that come too fast; else the stream waits
  bool colour = false;  // of stereo pairs
};

// How the frames went.
struct LiveCounts {
  int read = 0, dropped = 0;
  double longest_silence = 0.0;                  // seconds between two frames
  double longest_delay = 0.0, mean_delay = 0.0;  // seconds from the end of a frame's bytes until it was taken
};

class LiveFrames final : public FrameSource {
 public:
  // `stream` must outlive this object, at whose end it is stopped. `camera` says its size. Throws InputError
  // where the stream and the camera are of different sensors or sizes.
  LiveFrames(FrameStream& stream, const CameraFile& camera, const LiveSettings& settings);
  ~LiveFrames() override;

  const RecordedCamera& camera() const { return camera_; }
  // End: the stream has ended. What went wrong with it is thrown then.
  Next wait(double seconds) override;
  StereoImages next() override;
  FrameStamp newest() const override { return newest_; }
  StageTimer take_times() override;
  LiveCounts counts() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Slot {
    StreamFrame frame;
    Clock::time_point read;
  };
  void run();
  void keep_time(Clock::time_point now);

  FrameStream& stream_;
  const LiveSettings settings_;
  const double depth_factor_;
  RecordedCamera camera_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Slot reading_, waiting_, taken_;  // of the thread; shared; of who takes the frames
  bool is_waiting_ = false, ended_ = false, stopped_ = false;
  Clock::time_point first_read_, last_read_;
  double first_timestamp_ = 0.0;  // seconds
  double late_ = 0.0;             // seconds that the stream was silent, of one without times
  std::exception_ptr failure_;
  LiveCounts counts_;
  double delays_ = 0.0;  // their sum, seconds
  int taken_count_ = 0;
  FrameStamp newest_;
  StageTimer timer_{"images"};
  std::thread thread_;  // the last: it uses the others
};

}  // namespace penumbra::slam
