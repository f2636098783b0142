// Where `penumbra slam` takes its frames from: a recording, a stream on standard input ("-"), or cameras
// (/dev/video0).
#pragma once

#include <memory>

#include "apps/slam/slam_run.h"
#include "apps/view/slam_report.h"
#include "slam/sources/frame_source.h"
#include "slam/sources/live/live_frames.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

inline constexpr const char* kStandardInput = "-";
// Whether it is a device such as /dev/video0, or the name of one that is not there.
bool is_video_device(const std::string& name);

class FrameInput {
 public:
  // Throws as open_dataset and VideoStream do; UsageError for a stream without --camera.
  explicit FrameInput(const SlamOptions& options);

  // Of a stream: its camera, and no frames.
  const slam::StereoDataset& dataset() const { return *dataset_; }
  // From the first frame on.
  slam::FrameSource& frames() { return *frames_; }
  bool is_live() const { return live_ != nullptr; }
  // Of a stream: says how many frames were dropped and how late they were taken.
  void tell(SlamRun& run) const;

 private:
  void open_stream(const SlamOptions& options);
  void open_cameras(const SlamOptions& options, const slam::CameraFile& camera);

  std::unique_ptr<slam::StereoDataset> dataset_;
  std::unique_ptr<slam::ByteInput> bytes_;
  std::unique_ptr<slam::FrameStream> stream_;
  std::unique_ptr<slam::FrameSource> frames_;
  slam::LiveFrames* live_ = nullptr;  // frames_ of a stream
};

}  // namespace penumbra::apps
