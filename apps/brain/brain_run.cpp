#include "apps/brain/brain_run.h"

#include <fmt/core.h>

#include <memory>
#include <numbers>

#include "apps/brain/brain_results.h"
#include "apps/brain/landmark_finder.h"
#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "apps/common/process_usage.h"
#include "apps/common/progress_bar.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/parallel.h"
#include "nn/base/stopwatch.h"
#include "slam/brain/loaded_map.h"
#include "slam/brain/motion/odometry_file.h"
#include "slam/brain/motion/odometry_noise.h"
#include "slam/brain/motion/visual_odometry.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/prefetcher.h"

namespace penumbra::apps {

using slam::brain::SelfMotion;

namespace {

// Where the robot's self-motion is from: a file, the truth with noise, or the images themselves.
class MotionSource {
 public:
  MotionSource(const BrainOptions& options, const slam::StereoDataset& dataset,
               const slam::brain::CameraMount& mount, std::vector<std::string>& notes) {
    std::vector<double> times;
    for (int i = 0; i < dataset.size(); ++i) times.push_back(dataset.timestamp(i));
    if (!options.odometry.empty()) {
      slam::brain::OdometryOfFrames of = slam::brain::odometry_of_frames(
          slam::brain::read_odometry(options.odometry), times, options.odometry);
      of_frames_ = std::move(of.motions);
      notes.insert(notes.end(), of.notes.begin(), of.notes.end());
      name_ = "wheel odometry";
    } else if (!options.noise.empty()) {
      spoil_truth(options, dataset, mount);
      name_ = fmt::format("true motion, {} noise, seed {}", options.noise, options.seed);
    } else {
      visual_.emplace(dataset.camera(), dataset.sensor(), thread_count(), mount);
      name_ = "visual odometry";
    }
  }

  const std::string& name() const { return name_; }
  // What the images say about the motion that does not fit a robot on the ground; empty: nothing.
  std::string doubt() const {
    constexpr double kMostClimb = 0.15, kMostAside = 0.3;
    if (visual_ && visual_->side_share() > kMostAside) {
      return fmt::format(
          "{:.0f} % of the way leads to the robot's side, where wheels do not go: is the camera turned "
          "(--camera-yaw)?",
          100.0 * visual_->side_share());
    }
    if (!visual_ || visual_->climb_share() < kMostClimb) return {};
    return fmt::format(
        "{:.0f} % of the way goes up or down: the cognitive map is a plane and knows nothing of it (of a "
        "robot on "
        "the ground it is a few per cent); `penumbra slam` has no such limit",
        100.0 * visual_->climb_share());
  }
  int lost() const { return visual_ ? visual_->lost() : 0; }
  // `images`: null where they cannot be had.
  std::span<const SelfMotion> of(int i, const slam::StereoImages* images) {
    if (!visual_) return of_frames_[static_cast<std::size_t>(i)];
    if (images == nullptr) return {};
    step_ = visual_->next(*images);
    return {&step_, 1};
  }

 private:
  void spoil_truth(const BrainOptions& options, const slam::StereoDataset& dataset,
                   const slam::brain::CameraMount& mount) {
    const slam::brain::OdometryNoise noise = slam::brain::odometry_noise(options.noise);
    if (!dataset.ground_truth() || static_cast<int>(dataset.ground_truth()->size()) != dataset.size()) {
      throw UsageError(fmt::format(
          "--noise: expected a recording with a true pose for each of its {}, found {}",
          counted(dataset.size(), "frame"), dataset.ground_truth() ? dataset.ground_truth()->size() : 0));
    }
    for (const SelfMotion& motion : slam::brain::spoiled_odometry(
             *dataset.ground_truth(), noise, static_cast<std::uint64_t>(options.seed), mount))
      of_frames_.push_back({motion});
  }

  std::string name_;
  std::vector<std::vector<SelfMotion>> of_frames_;
  std::optional<slam::brain::VisualOdometry> visual_;
  SelfMotion step_;
};

slam::brain::CameraMount mount_of(const BrainOptions& options, const slam::StereoDataset& dataset) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  if (options.camera_yaw || options.camera_pitch || options.noise.empty() || !dataset.ground_truth())
    return {kDegree * options.camera_yaw.value_or(0.0), kDegree * options.camera_pitch.value_or(0.0)};
  slam::brain::CameraMount mount = slam::brain::CameraMount::of_path(*dataset.ground_truth());
  if (mount.yaw() != 0.0 || mount.pitch() != 0.0) {
    log_info("the true path says that the camera looks {:.0f} degrees to the left of the way and {:.0f} down",
             mount.yaw() / kDegree, mount.pitch() / kDegree);
  }
  return mount;
}

slam::brain::BrainSettings settings_of(const BrainOptions& options) {
  using slam::brain::BrainSettings;
  BrainSettings settings = options.templates == "ratslam" ? BrainSettings::ratslam() : BrainSettings();
  if (options.templates != "ratslam") {
    settings.templates = slam::brain::template_kind(options.templates);
    if (settings.templates == slam::brain::TemplateKind::intensity)
      settings.least_similarity = BrainSettings::least_profile_similarity;
    settings.least_sharpness = options.least_sharpness;
    settings.sight = options.sight == "on";
    settings.calibration = options.sight != "off";
  }
  settings.similarity.interest = options.interest == "on";
  settings.relaxation.mode = slam::brain::relaxation_mode(options.relaxation);
  settings.threads = thread_count();
  return settings;
}

void print_summary(const nlohmann::json& run, const std::filesystem::path& out) {
  fmt::print("{}: {}, {}, {}, {}, {} recalled, {:.2f} ms a frame (median)\n",
             run["dataset"].get<std::string>(), counted(run["frames"].get<std::uint64_t>(), "frame"),
             counted(run["keyframes"].get<std::uint64_t>(), "keyframe"),
             counted(run["nodes"].get<std::uint64_t>(), "node"),
             counted(run["links"].get<std::uint64_t>(), "link"), counted(run["recalls"].size(), "place"),
             run.value("median_ms", 0.0));
  if (run.contains("ground_truth")) {
    fmt::print("against the ground truth ({:.1f} m): APE {:.3f} m rmse by the settled map",
               run["ground_truth"]["path_m"].get<double>(), run["ground_truth"]["ape_rmse_m"].get<double>());
    if (run.contains("ground_truth_believed")) {
      fmt::print(", {:.3f} m as believed at the time",
                 run["ground_truth_believed"]["ape_rmse_m"].get<double>());
    }
    fmt::print("\n");
  }
  fmt::print("results in {}\n", out.string());
}

}  // namespace

void run_brain(const BrainOptions& options) {
  slam::brain::BrainSettings settings = settings_of(options);
  BrainRun run;
  const std::unique_ptr<slam::StereoDataset> dataset =
      slam::open_dataset(options.dataset.folder, dataset_options(options.dataset));
  run.dataset = dataset->name();
  run.warnings = dataset->notes();
  settings.mount = mount_of(options, *dataset);
  MotionSource motion(options, *dataset, settings.mount, run.warnings);
  run.motion = motion.name();
  for (const std::string& note : run.warnings) log_warning("{}", note);
  std::optional<slam::brain::StoredMap> loaded;
  if (!options.load_map.empty()) {
    loaded = slam::brain::read_cognitive_map(options.load_map);
    slam::brain::require_fitting(*loaded, dataset->camera(), settings, options.load_map);
  }
  nn::make_writable_folder(options.out);
  if (!options.save_map.empty()) {
    const std::filesystem::path folder = std::filesystem::path(options.save_map).parent_path();
    nn::require_writable_folder(folder.empty() ? "." : folder);
    if (std::filesystem::is_directory(options.save_map))
      throw UsageError(
          fmt::format("--save-map: expected a file's name, found the folder {}", options.save_map));
  }

  slam::brain::LandmarkFinder finder;
  if (settings.templates == slam::brain::TemplateKind::landmarks)
    finder = make_landmark_finder(options.weights);
  slam::brain::Brain brain(dataset->camera(), dataset->sensor(), settings, std::move(finder),
                           loaded ? &*loaded : nullptr);
  slam::brain::BrainRecorder record(settings.mount);
  bool was_located = brain.is_located();
  const Interruption interruption;
  const double cpu_before = process_usage().cpu_seconds;
  {
    slam::Prefetcher frames(*dataset);
    ProgressBar progress("Remembering", dataset->size());
    for (int i = 0; frames.has_next() && run.error.empty(); ++i) {
      if (Interruption::requested()) {
        run.error =
            fmt::format("interrupted by {} after {}", Interruption::signal_name(), counted(i, "frame"));
        break;
      }
      std::optional<slam::StereoImages> images;
      try {
        images = frames.next();
      } catch (const InputError& error) {
        run.warnings.push_back(error.what());
        log_warning("{}; the robot's motion alone is taken, where it is not by sight", error.what());
      }
      try {
        const std::span<const SelfMotion> motions = motion.of(i, images ? &*images : nullptr);
        const Stopwatch watch;
        slam::brain::BrainResult result =
            images ? brain.process(std::move(*images), motions)
                   : brain.process_missing(dataset->frame_number(i), dataset->timestamp(i), motions);
        if (result.recall && result.recall->loaded && !was_located) {
          log_info("frame {}: found the way into {}, at the place of its frame {}", result.frame,
                   options.load_map, result.recall->earlier_frame);
        }
        was_located = brain.is_located();
        if (result.recall && result.map_moved > 1.0) {
          log_info("frame {}: the place of frame {} again, the map moved by up to {:.2f} m", result.frame,
                   result.recall->earlier_frame, result.map_moved);
        }
        record.add(std::move(result), brain.map(), watch.milliseconds());
      } catch (const std::exception& error) {
        run.error = error.what();
      }
      progress.update(i + 1);
    }
  }
  if (record.results().empty()) throw Error(run.error.empty() ? "the recording has no frames" : run.error);
  brain.finish();
  run.lost = motion.lost();
  std::vector<std::string> doubts = {motion.doubt(), brain.odometry_doubt()};
  if (run.lost > 0) {
    doubts.push_back(
        fmt::format("visual odometry was lost in {} of {}, where the last motion was taken to go on",
                    run.lost, counted(record.results().size(), "frame")));
  }
  if (brain.maps_that_flew_apart() > 0) {
    doubts.push_back(fmt::format("the map flew apart in {}, and was left as it was",
                                 counted(brain.maps_that_flew_apart(), "relaxation")));
  }
  for (const std::string& doubt : doubts) {
    if (doubt.empty()) continue;
    log_warning("{}", doubt);
    run.warnings.push_back(doubt);
  }
  const ProcessUsage usage = process_usage();
  run.cpu_seconds = usage.cpu_seconds - cpu_before;
  run.peak_rss_mb = usage.peak_rss_mb;
  if (!brain.is_located())
    log_warning("no place of {} was recalled: the way begins where this run did", options.load_map);
  print_summary(write_brain_results(options.out, *dataset, brain, record, run, options.save_map),
                options.out);
  if (!run.error.empty()) throw Error(run.error);
}

}  // namespace penumbra::apps
