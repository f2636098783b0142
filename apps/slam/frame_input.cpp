#include "apps/slam/frame_input.h"

#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>

#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/live/video_stream.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/prefetcher.h"

namespace penumbra::apps {

namespace {

// What a stream can say beforehand.
class StreamDescription final : public slam::StereoDataset {
 public:
  StreamDescription(std::string name, const slam::RecordedCamera& camera, slam::Sensor sensor,
                    std::vector<std::string> notes)
      : name_(std::move(name)), camera_(camera), sensor_(sensor), notes_(std::move(notes)) {}
  std::string name() const override { return name_; }
  slam::Sensor sensor() const override { return sensor_; }
  const slam::StereoCamera& camera() const override { return camera_.camera; }
  int size() const override { return 0; }
  int frame_number(int i) const override { return i; }
  double timestamp(int) const override { return 0.0; }
  slam::StereoImages load(int) const override {
    throw Error("a stream's frames are gone once they are taken");
  }
  const std::optional<slam::Trajectory>& ground_truth() const override { return no_truth_; }
  const std::vector<slam::Mounting>& mountings() const override { return camera_.mountings; }
  const std::vector<std::string>& notes() const override { return notes_; }

 private:
  const std::string name_;
  const slam::RecordedCamera camera_;
  const slam::Sensor sensor_;
  const std::vector<std::string> notes_;
  const std::optional<slam::Trajectory> no_truth_;
};

slam::StereoLayout layout_of(const SlamOptions& options) {
  return options.layout == "top-bottom" ? slam::StereoLayout::top_bottom : slam::StereoLayout::side_by_side;
}

}  // namespace

bool is_video_device(const std::string& name) {
  std::error_code error;
  return name.starts_with("/dev/") &&
         (name.starts_with("/dev/video") || std::filesystem::is_character_file(name, error));
}

FrameInput::FrameInput(const SlamOptions& options) {
  const std::string& from = options.dataset.folder;
  if (from == kStandardInput || is_video_device(from)) {
    open_stream(options);
    return;
  }
  if (!options.right_device.empty())
    throw UsageError(fmt::format("--right-device goes with a camera such as /dev/video0, not with {}", from));
  dataset_ = slam::open_dataset(from, dataset_options(options.dataset));
  frames_ = std::make_unique<slam::Prefetcher>(*dataset_);
}

void FrameInput::open_stream(const SlamOptions& options) {
  const bool is_pipe = options.dataset.folder == kStandardInput;
  const std::string name = is_pipe ? "standard input" : options.dataset.folder;
  if (options.dataset.camera.empty())
    throw UsageError(
        fmt::format("a stream, here {}, needs --camera calibration.yaml (docs/datasets.md)", name));
  slam::CameraFile camera = slam::read_camera_file(options.dataset.camera);
  if (is_pipe) {
    bytes_ = std::make_unique<slam::ByteInput>(STDIN_FILENO, name);
    stream_ =
        slam::open_frame_stream(*bytes_, layout_of(options),
                                options.dataset.frame_rate ? options.dataset.frame_rate : camera.frame_rate);
  } else {
    open_cameras(options, camera);
  }
  slam::take_size(stream_->size(), camera);
  slam::LiveSettings settings;
  settings.drops = !options.every_frame;
  settings.colour = options.dataset.images == "colour" ||
                    (options.dataset.images == "auto" && camera.colour.value_or(false));
  auto live = std::make_unique<slam::LiveFrames>(*stream_, camera, settings);
  live_ = live.get();
  dataset_ = std::make_unique<StreamDescription>(is_pipe ? "stream" : stream_->name(), live->camera(),
                                                 stream_->sensor(), camera.notes);
  frames_ = std::move(live);
}

void FrameInput::open_cameras(const SlamOptions& options, const slam::CameraFile& camera) {
  slam::VideoStreamOptions video;
  video.left = options.dataset.folder;
  video.right = options.right_device;
  video.layout = layout_of(options);
  video.size = {camera.left.width, camera.left.height};
  video.rate = options.dataset.frame_rate.value_or(camera.frame_rate.value_or(0.0));
  auto stream = std::make_unique<slam::VideoStream>(video);
  log_info("{}", stream->description());
  stream_ = std::move(stream);
}

void FrameInput::tell(SlamRun& run) const {
  if (live_ == nullptr) return;
  const slam::LiveCounts counts = live_->counts();
  run.stream = {{"frames", counts.read},
                {"dropped", counts.dropped},
                {"mean_delay_s", counts.mean_delay},
                {"longest_delay_s", counts.longest_delay},
                {"longest_silence_s", counts.longest_silence}};
  if (Interruption::requested()) run.stream["ended_by"] = Interruption::signal_name();
  log_info(
      "the stream had {}, of which {} {} dropped; a frame waited {:.0f} ms at the mean, {:.0f} ms at most",
      counted(counts.read, "frame"), counts.dropped, counts.dropped == 1 ? "was" : "were",
      1e3 * counts.mean_delay, 1e3 * counts.longest_delay);
  if (const std::string remark = stream_->remark(); !remark.empty()) {
    run.stream["remark"] = remark;
    log_info("{}", remark);
  }
}

}  // namespace penumbra::apps
