#include "apps/brain/brain_rows.h"

#include <memory>

#include "apps/brain/brain_figures.h"
#include "apps/brain/brain_results.h"
#include "apps/common/progress_bar.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/stopwatch.h"
#include "slam/brain/brain_recorder.h"
#include "slam/sources/prefetcher.h"

namespace penumbra::apps {

using slam::brain::BrainSettings;

namespace {

class RunningRow {
 public:
  RunningRow(const slam::StereoDataset& dataset, const BrainRow& row,
             const slam::brain::LandmarkFinder& finder)
      : name_(row.name) {
    if (row.geometric) {
      slam::SlamSettings settings;
      settings.threads = row.settings.threads;
      settings.deterministic = true;  // the worker's time is the frame's
      slam_ = std::make_unique<slam::Slam>(dataset.camera(), dataset.sensor(), settings);
      slam_record_ = std::make_unique<slam::Recorder>(*slam_);
    } else {
      brain_ = std::make_unique<slam::brain::Brain>(dataset.camera(), dataset.sensor(), row.settings, finder);
      record_ = slam::brain::BrainRecorder(row.settings.mount);
    }
  }

  void process(const slam::StereoImages& images, const slam::brain::SelfMotion& motion) {
    const Stopwatch watch;
    if (slam_) {
      slam_record_->add(slam_->process(images));
      slam_milliseconds_.push_back(watch.milliseconds());
    } else {
      slam::brain::BrainResult result = brain_->process(images, std::span(&motion, 1));
      record_.add(std::move(result), brain_->map(), watch.milliseconds());
    }
  }

  // `pictures`: a folder for them, or empty.
  nlohmann::json finish(const slam::StereoDataset& dataset, const std::filesystem::path& pictures) {
    const slam::Trajectory& truth = *dataset.ground_truth();
    nlohmann::json figures;
    if (slam_) {
      slam_record_->finish();
      figures = geometric_figures(truth, *slam_record_, slam_milliseconds_);
    } else {
      brain_->finish();
      figures = brain_figures(truth, *brain_, record_);
      if (!pictures.empty()) {
        nn::make_writable_folder(pictures / name_);
        ResultWriter writer;
        draw_brain_run(writer, pictures / name_, dataset.name(), paths_of(dataset, *brain_, record_),
                       brain_->map(), record_);
      }
    }
    figures["name"] = name_;
    figures["stages"] = stages_of(slam_ ? slam_->timer() : brain_->timer());
    return figures;
  }

 private:
  static nlohmann::json stages_of(const StageTimer& timer) {
    nlohmann::json stages;
    for (const auto& [stage, times] : timer.stages()) {
      double sum = 0.0;
      for (const double time : times.values()) sum += time;
      stages[stage] = {{"mean_ms", sum / static_cast<double>(times.values().size())},
                       {"times", times.values().size()}};
    }
    return stages;
  }

  std::string name_;
  std::unique_ptr<slam::brain::Brain> brain_;
  slam::brain::BrainRecorder record_;
  std::unique_ptr<slam::Slam> slam_;
  std::unique_ptr<slam::Recorder> slam_record_;
  std::vector<double> slam_milliseconds_;
};

const slam::Trajectory& truth_of(const slam::StereoDataset& dataset) {
  if (!dataset.ground_truth() || static_cast<int>(dataset.ground_truth()->size()) != dataset.size()) {
    throw InputError(dataset.name(),
                     fmt::format("a true pose for each of its {}", counted(dataset.size(), "frame")),
                     fmt::format("{}", dataset.ground_truth() ? dataset.ground_truth()->size() : 0));
  }
  return *dataset.ground_truth();
}

}  // namespace

std::vector<std::string> brain_row_names() {
  return {"odometry", "ratslam", "no-interest", "no-sharpness", "ours", "slam"};
}

BrainRow brain_row(const std::string& name) {
  BrainRow row;
  row.name = name;
  if (name == "odometry") {
    row.settings.recall = false;
  } else if (name == "ratslam") {
    row.settings = BrainSettings::ratslam();
  } else if (name == "no-interest") {
    row.settings.similarity.interest = false;
  } else if (name == "no-sharpness") {
    row.settings.least_sharpness = 0.0;
  } else if (name == "intensity-geometry") {
    row.settings.templates = slam::brain::TemplateKind::intensity;
    row.settings.least_similarity = BrainSettings::least_profile_similarity;
  } else if (name == "slam") {
    row.geometric = true;
  } else if (name != "ours") {
    throw UsageError(
        fmt::format("--rows: expected odometry, ratslam, no-interest, no-sharpness, ours, slam or "
                    "intensity-geometry, found '{}'",
                    name));
  }
  return row;
}

std::vector<nlohmann::json> run_brain_rows(const slam::StereoDataset& dataset,
                                           const std::vector<BrainRow>& rows,
                                           const slam::brain::OdometryNoise& noise, std::uint64_t seed,
                                           const slam::brain::LandmarkFinder& finder,
                                           const std::string& title, const std::filesystem::path& pictures) {
  const slam::Trajectory& truth = truth_of(dataset);
  const slam::brain::CameraMount mount = slam::brain::CameraMount::of_path(truth);
  const std::vector<slam::brain::SelfMotion> motions =
      slam::brain::spoiled_odometry(truth, noise, seed, mount);
  std::vector<std::unique_ptr<RunningRow>> running;
  for (BrainRow row : rows) {
    row.settings.mount = mount;
    running.push_back(std::make_unique<RunningRow>(dataset, row, finder));
  }
  slam::Prefetcher frames(dataset);
  ProgressBar progress(title, dataset.size());
  for (int i = 0; frames.has_next(); ++i) {
    slam::StereoImages images = frames.next();
    images.index = i;
    for (const std::unique_ptr<RunningRow>& row : running)
      row->process(images, motions[static_cast<std::size_t>(i)]);
    progress.update(i + 1);
  }
  std::vector<nlohmann::json> figures;
  for (const std::unique_ptr<RunningRow>& row : running) figures.push_back(row->finish(dataset, pictures));
  return figures;
}

}  // namespace penumbra::apps
