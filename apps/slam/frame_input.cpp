#include "apps/slam/frame_input.h"

#include <fmt/core.h>
#include <unistd.h>

#include "apps/common/log.h"
#include "nn/base/error.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/prefetcher.h"

namespace penumbra::apps {

namespace {

// What a stream can say beforehand.
class StreamDescription final : public slam::StereoDataset {
 public:
  StreamDescription(const slam::StereoCamera& camera, slam::Sensor sensor, std::vector<std::string> notes)
      : camera_(camera), sensor_(sensor), notes_(std::move(notes)) {}
  std::string name() const override { return "stream"; }
  slam::Sensor sensor() const override { return sensor_; }
  const slam::StereoCamera& camera() const override { return camera_; }
  int size() const override { return 0; }
  int frame_number(int i) const override { return i; }
  double timestamp(int) const override { return 0.0; }
  slam::StereoImages load(int) const override {
    throw Error("a stream's frames are gone once they are taken");
  }
  const std::optional<slam::Trajectory>& ground_truth() const override { return no_truth_; }
  const std::vector<std::string>& notes() const override { return notes_; }

 private:
  const slam::StereoCamera camera_;
  const slam::Sensor sensor_;
  const std::vector<std::string> notes_;
  const std::optional<slam::Trajectory> no_truth_;
};

}  // namespace

FrameInput::FrameInput(const SlamOptions& options) {
  if (options.dataset.folder == kStandardInput) {
    open_stream(options);
    return;
  }
  dataset_ = slam::open_dataset(options.dataset.folder, dataset_options(options.dataset));
  frames_ = std::make_unique<slam::Prefetcher>(*dataset_);
}

void FrameInput::open_stream(const SlamOptions& options) {
  if (options.dataset.camera.empty())
    throw UsageError("a stream on standard input needs --camera calibration.yaml (docs/datasets.md)");
  slam::CameraFile camera = slam::read_camera_file(options.dataset.camera);
  bytes_ = std::make_unique<slam::ByteInput>(STDIN_FILENO, "standard input");
  const auto layout =
      options.layout == "top-bottom" ? slam::StereoLayout::top_bottom : slam::StereoLayout::side_by_side;
  stream_ = slam::open_frame_stream(
      *bytes_, layout, options.dataset.frame_rate ? options.dataset.frame_rate : camera.frame_rate);
  slam::take_size(stream_->size(), camera);
  slam::LiveSettings settings;
  settings.drops = !options.every_frame;
  settings.colour = options.dataset.images == "colour" ||
                    (options.dataset.images == "auto" && camera.colour.value_or(false));
  auto live = std::make_unique<slam::LiveFrames>(*stream_, *bytes_, camera, settings);
  live_ = live.get();
  dataset_ = std::make_unique<StreamDescription>(live->camera(), stream_->sensor(), camera.notes);
  frames_ = std::move(live);
}

void FrameInput::tell(SlamRun& run) const {
  if (live_ == nullptr) return;
  const slam::LiveCounts counts = live_->counts();
  run.stream = {{"frames", counts.read},
                {"dropped", counts.dropped},
                {"mean_delay_s", counts.mean_delay},
                {"longest_delay_s", counts.longest_delay}};
  log_info(
      "of {} frames of the stream {} were dropped; a frame waited {:.0f} ms at the mean, {:.0f} ms at most",
      counts.read, counts.dropped, 1e3 * counts.mean_delay, 1e3 * counts.longest_delay);
}

}  // namespace penumbra::apps
