// penumbra slam: from a stereo sequence to a trajectory and a map.

#include <fmt/core.h>
#include <omp.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "apps/commands.h"
#include "apps/compute_options.h"
#include "apps/dataset_arguments.h"
#include "apps/frames_report.h"
#include "apps/keyframe_gallery.h"
#include "apps/process_usage.h"
#include "apps/progress_bar.h"
#include "apps/segmenter.h"
#include "apps/slam_report.h"
#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/image_file.h"
#include "slam/datasets/open_dataset.h"
#include "slam/datasets/prefetcher.h"
#include "slam/evaluation/association.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/map_file.h"
#include "slam/map/ply.h"
#include "slam/slam.h"

namespace penumbra::apps {

namespace {

constexpr const char* kSlamExamples = R"(Examples:
  penumbra slam kitti --sequence 00 --out out/00
  penumbra slam kitti --sequence 06 --frames 0:50 --filter off --out out/06
  penumbra slam kitti/sequences/00 --weights maskrcnn.safetensors --out out/00
  penumbra slam out/street --masks out/street/sequences/00/instances --out out/street_slam
  penumbra slam V1_01_easy --out out/V1_01                    EuRoC: the folder with mav0/
  penumbra slam rgbd_dataset_freiburg1_xyz --out out/xyz      TUM RGB-D
  penumbra slam my_camera --step 2 --out out/mine             images and a calibration.yaml (docs/datasets.md)
  penumbra slam monday --save-map yard.map --out out/monday
  penumbra slam tuesday --load-map yard.map --save-map yard.map --out out/tuesday      go on building the map
  penumbra slam wednesday --load-map yard.map --localise --out out/wednesday           only find the way in it

Writes into the --out folder: trajectory_kitti.txt (camera poses, one a frame; predicted where it is lost),
trajectory_tum.txt (the frames that were located), keyframes_tum.txt (the keyframes' alone), map.ply (points and keyframes), trajectory.png (seen from above), run.json (settings, counts, times,
loops, errors against the ground truth), frames.json (the same frame by frame), gallery (keyframes with their features). `penumbra report` makes a page of them.)";

struct SlamOptions {
  DatasetArguments dataset;
  std::string out, sequence, weights, classes, masks, save_map, load_map;
  std::string images = "auto", filter = "adaptive", loops = "on";
  std::string segmentation = "keyframes", moving = "geometry", movers = "on";
  std::optional<double> frame_rate;
  double least_sharpness = 0.0;
  bool deterministic = false, localise = false;
  int features = 0, threads = omp_get_max_threads(), segmentation_threads = 0;
};

volatile std::sig_atomic_t interrupted = 0;

// While it lives, Ctrl-C ends the loop over the frames instead of the program.
class InterruptGuard {
 public:
  InterruptGuard() : before_(std::signal(SIGINT, [](int) { interrupted = 1; })) {}
  ~InterruptGuard() { std::signal(SIGINT, before_); }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  void (*before_)(int);
};

void parse_segmentation(const std::string& text, slam::SemanticsSettings& semantics) {
  using Mode = slam::SegmentationMode;
  constexpr std::string_view kEvery = "every-";
  if (text == "keyframes" || text == "all" || text == "off") {
    semantics.mode = text == "keyframes" ? Mode::keyframes : text == "all" ? Mode::all : Mode::off;
    return;
  }
  const std::string number = text.rfind(kEvery, 0) == 0 ? text.substr(kEvery.size()) : "";
  const bool is_number =
      !number.empty() && number.size() <= 6 && number.find_first_not_of("0123456789") == number.npos;
  if (!is_number || std::stoi(number) == 0) {
    throw UsageError(fmt::format(
        "--segmentation: expected 'keyframes', 'every-N' such as 'every-5', 'all' or 'off', found '{}'",
        text));
  }
  semantics.mode = Mode::interval;
  semantics.interval = std::stoi(number);
}

// Empty where no segmentation by a network is asked for.
std::optional<LoadedNetwork> find_network(const SlamOptions& options) {
  if (options.segmentation == "off" || options.weights.empty()) return std::nullopt;
  return load_network(options.weights, options.classes, slam_network_config());
}

slam::DatasetCameras parse_cameras(const std::string& images) {
  if (images == "grey") return slam::DatasetCameras::grey;
  return images == "colour" ? slam::DatasetCameras::colour : slam::DatasetCameras::automatic;
}

slam::SlamSettings make_settings(const SlamOptions& options) {
  slam::SlamSettings settings;
  settings.orb.features = options.features;
  settings.tracker.mismatch_filter.mode = slam::mismatch_filter_mode(options.filter);
  settings.loops.enabled = options.loops == "on";
  settings.tracker.least_sharpness = options.least_sharpness;
  parse_segmentation(options.segmentation, settings.semantics);
  settings.semantics.instances.check_motion = options.moving == "geometry";
  settings.tracker.rigid_mover.enabled = settings.semantics.instances.companions.enabled =
      options.movers == "on";
  settings.localise = options.localise;
  settings.threads = options.threads;
  settings.semantics.threads = options.segmentation_threads;
  settings.deterministic = options.deterministic;
  return settings;
}

// The map of --load-map; nothing where none is asked for.
std::unique_ptr<slam::Map> load_map(const SlamOptions& options, const slam::StereoCamera& camera) {
  if (options.load_map.empty()) return nullptr;
  slam::SavedMap saved = slam::read_map(options.load_map);
  slam::require_same_camera(saved.camera, camera, options.load_map);
  return std::move(saved.map);
}

// Runs until the end, Ctrl-C or the first frame that cannot be read; returns what stopped it, empty at the
// end.
std::string process_frames(const slam::StereoDataset& dataset, slam::Slam& slam) {
  const InterruptGuard guard;
  slam::Prefetcher frames(dataset);
  ProgressBar progress("Tracking", dataset.size());
  std::size_t reported_loops = 0;
  while (frames.has_next()) {
    if (interrupted) return fmt::format("interrupted after {} frames", slam.results().size());
    try {
      const slam::FrameResult result = slam.process(frames.next());
      if (result.tracking.state == slam::TrackingState::lost) spdlog::warn("frame {}: lost", result.index);
      progress.update(static_cast<int>(slam.results().size()));
      const std::vector<slam::ClosedLoop> loops = slam.loops();
      for (; reported_loops < loops.size(); ++reported_loops) {
        const slam::ClosedLoop& loop = loops[reported_loops];
        spdlog::info("frame {}: loop with frame {} closed, {} points, {:.2f} m", loop.frame,
                     loop.earlier_frame, loop.inliers, loop.correction_metres);
      }
      if (result.tracking.recovered) spdlog::info("frame {}: found again", result.index);
    } catch (const Error& error) {
      return error.what();
    }
  }
  return {};
}

// Poses of the frames that were located.
slam::Trajectory located(const slam::Slam& slam) {
  slam::Trajectory all = slam.trajectory(), located;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (slam.results()[i].tracking.state == slam::TrackingState::tracking) located.push_back(all[i]);
  }
  return located;
}

// Ground truth and estimate of the frames that have both, the ground truth moved so that it starts where the
// estimate starts.
slam::TrajectoryPair pair_with_ground_truth(const slam::StereoDataset& dataset,
                                            const slam::Trajectory& estimate) {
  slam::TrajectoryPair pair;
  if (!dataset.ground_truth()) return pair;
  std::size_t at = 0;
  for (const slam::TimedPose& pose : *dataset.ground_truth()) {  // with the frames' own times
    while (at < estimate.size() && estimate[at].timestamp < pose.timestamp) ++at;
    if (at == estimate.size()) break;
    if (estimate[at].timestamp != pose.timestamp) continue;
    pair.reference.push_back(pose);
    pair.estimate.push_back(estimate[at]);
  }
  if (pair.reference.empty()) return pair;
  const slam::SE3 moved = pair.estimate.front().T_wc * pair.reference.front().T_wc.inverse();
  for (slam::TimedPose& pose : pair.reference) pose.T_wc = moved * pose.T_wc;
  return pair;
}

std::optional<slam::Evaluation> evaluate(const slam::TrajectoryPair& pair) {
  if (pair.reference.size() < 2) return std::nullopt;
  slam::EvaluationOptions options;
  // Short pieces have no segment of a hundred metres.
  if (slam::path_length(pair.reference) < 200.0) options.segment_lengths = {10.0, 20.0, 30.0, 40.0, 50.0};
  return slam::evaluate_trajectory(pair.reference, pair.estimate, options);
}

// Pieces of the map that nothing ties to the first stand where they were guessed.
void warn_of_pieces(const slam::Slam& slam) {
  const std::vector<slam::SubmapSummary> submaps = slam.submaps();
  for (std::size_t i = 1; i < submaps.size(); ++i) {
    if (submaps[i].frames == 0) continue;  // of a map that was loaded
    spdlog::warn(
        "frames {} to {}: the way was lost before and no place of the earlier map was seen since; these {} "
        "frames are right relative to each other, where they are is a guess",
        submaps[i].first_frame, submaps[i].last_frame, submaps[i].frames);
  }
}

void write_results(const std::filesystem::path& out, const slam::StereoDataset& dataset,
                   const slam::Slam& slam, SlamRun& run) {
  const slam::Trajectory estimate = located(slam);
  const slam::TrajectoryPair pair = pair_with_ground_truth(dataset, estimate);
  const slam::Trajectory& truth = pair.reference;
  run.evaluation = evaluate(pair);
  if (!slam.results().empty()) {
    slam::write_kitti_poses(out / "trajectory_kitti.txt", slam.trajectory());
    slam::write_tum_trajectory(out / "trajectory_tum.txt", estimate);
    slam::write_tum_trajectory(out / "keyframes_tum.txt", slam.keyframe_trajectory());
    if (!truth.empty()) slam::write_tum_trajectory(out / "ground_truth_tum.txt", truth);
  }
  if (!estimate.empty()) {
    slam::TrajectoryPlotOptions plot;
    plot.title = dataset.name();
    nn::write_image(out / "trajectory.png", slam::draw_trajectories(estimate, truth, plot));
  }
  slam::write_ply(out / "map.ply", slam.map());
  write_keyframe_gallery(out / "gallery", dataset, slam);
  nn::write_file(out / "frames.json", frames_report(slam).dump() + "\n");
  nn::write_file(out / "run.json", to_text(slam_report(run, slam)));
}

void print_summary(const nlohmann::json& report, const std::filesystem::path& out) {
  fmt::print("{}: {} frames, {} tracked, {} lost, {} keyframes, {} map points, {:.1f} ms a frame (median)\n",
             report["dataset"].get<std::string>(), report["frames"].get<int>(), report["tracked"].get<int>(),
             report["lost"].get<int>(), report["keyframes"].get<int>(), report["map_points"].get<int>(),
             report.value("median_ms", 0.0));
  if (report.contains("ground_truth")) {
    const nlohmann::json& truth = report["ground_truth"];
    fmt::print("against the ground truth ({:.1f} m): APE {:.3f} m rmse", truth["path_m"].get<double>(),
               truth["ape_rmse_m"].get<double>());
    if (truth.contains("t_rel_percent")) {
      fmt::print(", drift {:.2f} % and {:.2f} deg/100 m", truth["t_rel_percent"].get<double>(),
                 truth["r_rel_deg_per_100m"].get<double>());
    }
    fmt::print("\n");
  }
  fmt::print("results in {}\n", out.string());
}

void run_slam(const SlamOptions& options) {
  SlamRun run;
  run.settings = make_settings(options);
  run.deterministic = options.deterministic;
  slam::DatasetOptions from = dataset_options(options.dataset);
  from.sequence = options.sequence;
  from.cameras = parse_cameras(options.images);
  from.frame_rate = options.frame_rate;

  const std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(options.dataset.folder, from);
  run.dataset = dataset->name();
  for (const std::string& note : dataset->notes()) spdlog::warn("{}: {}", options.dataset.folder, note);
  const std::optional<LoadedNetwork> loaded = find_network(options);
  slam::Segmenter segmenter;
  if (loaded) segmenter = make_segmenter(*loaded);
  if (!options.masks.empty() && options.segmentation != "off") segmenter = make_mask_reader(options.masks);
  run.segmentation = segmenter ? options.segmentation : "off";
  std::unique_ptr<slam::Map> map = load_map(options, dataset->camera());
  const std::filesystem::path save_folder = std::filesystem::path(options.save_map).parent_path();
  std::error_code error;
  if (!save_folder.empty() && !std::filesystem::is_directory(save_folder, error)) {
    throw InputError(save_folder.string(), "a folder for the map", "none");
  }
  const std::filesystem::path out = options.out;
  std::filesystem::create_directories(out, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", out.string(), error.message()));

  omp_set_num_threads(run.settings.threads);
  cv::setNumThreads(1);  // the frames' two images are the parallel work
  slam::Slam slam(dataset->camera(), run.settings, segmenter, std::move(map));
  const double cpu_before = process_usage().cpu_seconds;
  run.error = process_frames(*dataset, slam);
  slam.finish();
  const ProcessUsage usage = process_usage();
  run.cpu_seconds = usage.cpu_seconds - cpu_before;
  run.peak_rss_mb = usage.peak_rss_mb;
  warn_of_pieces(slam);
  if (loaded) run.peak_arena_bytes = loaded->network->arena().peak_bytes();
  write_results(out, *dataset, slam, run);
  if (!options.save_map.empty()) slam::write_map(options.save_map, dataset->camera(), slam.map());
  print_summary(slam_report(run, slam), out);
  if (!run.error.empty()) throw Error(run.error);
}

}  // namespace

void add_slam_command(CLI::App& app) {
  const auto options = std::make_shared<SlamOptions>();
  CLI::App* command =
      app.add_subcommand("slam", "Estimate the camera's path and a map from a stereo or RGB-D sequence");
  command->footer(kSlamExamples);
  add_dataset_arguments(*command, options->dataset, "folder of the sequence");
  command->add_option("--out", options->out, "folder for the results, made where it is missing")->required();
  command->add_option("--images", options->images, "which images to read")
      ->check(CLI::IsMember({"auto", "grey", "colour"}))
      ->capture_default_str();
  command->add_option("--rate", options->frame_rate, "frames a second, where the dataset has no times")
      ->check(CLI::PositiveNumber)
      ->type_name("HZ");
  command->add_option("--sequence", options->sequence,
                      "which one, where the folder holds several, such as 00");
  command
      ->add_option("--weights", options->weights, "Mask R-CNN or YOLOv5-seg weights: what moves is left out")
      ->type_name("FILE");
  command
      ->add_option("--masks", options->masks,
                   "folder of masks as `penumbra synth` writes, instead of weights")
      ->excludes("--weights")
      ->type_name("DIR");
  command->add_option("--classes", options->classes,
                      "file of the weights' class names, one a line (default: the weights' own, or COCO)");
  command
      ->add_option("--segmentation", options->segmentation,
                   "frames that are segmented: keyframes, every-N, all (tracking waits), off")
      ->capture_default_str()
      ->type_name("WHICH");
  command
      ->add_option("--moving", options->moving,
                   "what is left out: instances that geometry finds moving, or every class that can move")
      ->check(CLI::IsMember({"geometry", "class"}))
      ->capture_default_str();
  command->add_option("--movers", options->movers, "find large moving things without masks, by geometry")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command->add_option("--filter", options->filter, "histogram mismatch filter")
      ->check(CLI::IsMember({"off", "paper", "adaptive"}))
      ->capture_default_str();
  command->add_option("--loops", options->loops, "close loops when a place is seen again")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option(
          "--least-sharpness", options->least_sharpness,
          "a frame below this share of the last images' sharpness (Tenengrad) leaves it to one of the next "
          "three to become a keyframe; 0: no test")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--features", options->features, "features per image; 0 chooses by the image's size")
      ->check(CLI::Range(0, 20000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "threads (default: all processors)")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command
      ->add_option("--segmentation-threads", options->segmentation_threads,
                   "threads of the network beside the tracker (default: all of --threads but one)")
      ->check(CLI::Range(1, 256))
      ->type_name("N");
  CLI::Option* load = command
                          ->add_option("--load-map", options->load_map,
                                       "begin with the map of an earlier run of the same camera")
                          ->type_name("FILE");
  CLI::Option* save = command->add_option("--save-map", options->save_map, "write the map there at the end")
                          ->type_name("FILE");
  command
      ->add_flag("--localise", options->localise,
                 "only find the way in the loaded map, and leave it as it is")
      ->needs(load)
      ->excludes(save);
  add_isa_option(command);
  command->add_flag("--deterministic", options->deterministic,
                    "mapping in line with tracking: results repeat bit for bit");
  command->callback([options] { run_slam(*options); });
}

}  // namespace penumbra::apps
