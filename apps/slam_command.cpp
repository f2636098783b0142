// penumbra slam: from a stereo sequence to a trajectory and a map.

#include <fmt/core.h>
#include <omp.h>
#include <spdlog/spdlog.h>

#include <charconv>
#include <csignal>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "apps/commands.h"
#include "apps/compute_options.h"
#include "apps/dataset_arguments.h"
#include "apps/live_view.h"
#include "apps/process_usage.h"
#include "apps/progress_bar.h"
#include "apps/segmenter.h"
#include "apps/slam_results.h"
#include "nn/base/error.h"
#include "slam/datasets/open_dataset.h"
#include "slam/datasets/prefetcher.h"
#include "slam/map/map_file.h"
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
  penumbra slam kitti --sequence 00 --out out/00 --view       watch it: a page on http://127.0.0.1:8080/, for this machine alone

Writes into the --out folder: trajectory_kitti.txt (camera poses, one a frame; predicted where it is lost),
trajectory_tum.txt (the frames that were located), keyframes_tum.txt (the keyframes' alone), map.ply (points and keyframes), trajectory.png (seen from above), run.json (settings, counts, times,
loops, errors against the ground truth), frames.json (the same frame by frame), gallery (keyframes with their features). `penumbra report` makes a page of them; with
--view the page is there while the run goes on.)";

// --view without a port.
constexpr const char* kAnyViewPort = "auto";

struct SlamOptions {
  DatasetArguments dataset;
  std::string out, sequence, weights, classes, masks, save_map, load_map;
  std::string images = "auto", filter = "adaptive", loops = "on", constellation = "on",
              self_calibration = "on";
  std::string segmentation = "keyframes", moving = "geometry", movers = "on";
  std::string view;  // port, or kAnyViewPort; empty: none
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
  settings.loops.enabled = options.loops != "off";
  settings.loops.corrects = options.loops == "on";
  settings.loops.verifier.constellation.enabled = options.constellation == "on";
  if (options.self_calibration == "off") settings.full_bundle.disparity_offset_sigma = 0.0;
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

// The port of --view; none: the first that is free.
std::optional<int> view_port(const std::string& text) {
  if (text.empty() || text == kAnyViewPort) return std::nullopt;
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stop != end || port < 0 || port > 65535) {
    throw UsageError(fmt::format("--view: expected a port from 0 to 65535, found '{}'", text));
  }
  return port;
}

// The map of --load-map; nothing where none is asked for.
std::unique_ptr<slam::Map> load_map(const SlamOptions& options, const slam::StereoCamera& camera) {
  if (options.load_map.empty()) return nullptr;
  std::unique_ptr<slam::Map> map = slam::read_map(options.load_map);
  slam::require_same_camera(map->camera(), camera, options.load_map);
  return map;
}

// Runs until the end, Ctrl-C or the first frame that cannot be read; returns what stopped it, empty at the
// end.
std::string process_frames(const slam::StereoDataset& dataset, slam::Slam& slam, LiveView* view) {
  const InterruptGuard guard;
  slam::Prefetcher frames(dataset);
  ProgressBar progress("Tracking", dataset.size());
  std::size_t reported_loops = 0;
  while (frames.has_next()) {
    if (interrupted) return fmt::format("interrupted after {} frames", slam.results().size());
    try {
      const slam::StereoImages images = frames.next();
      const slam::FrameResult result = slam.process(images);
      if (view != nullptr) view->add(result, images.left);
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

void run_slam(const SlamOptions& options) {
  const std::optional<int> port = view_port(options.view);
  SlamRun run;
  run.settings = make_settings(options);
  run.deterministic = options.deterministic;
  slam::DatasetOptions from = dataset_options(options.dataset);
  from.sequence = options.sequence;
  from.cameras = parse_cameras(options.images);
  from.frame_rate = options.frame_rate;

  const std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(options.dataset.folder, from);
  run.dataset = dataset->name();
  // The right columns of an RGB-D camera follow from its depth.
  if (dataset->sensor() == slam::Sensor::rgbd) run.settings.full_bundle.disparity_offset_sigma = 0.0;
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
  std::optional<LiveView> view;
  if (!options.view.empty()) {
    view.emplace(port, run, dataset->size(), slam);
    spdlog::info("watch it on {}", view->address());
  }
  const double cpu_before = process_usage().cpu_seconds;
  run.error = process_frames(*dataset, slam, view ? &*view : nullptr);
  slam.finish();
  const ProcessUsage usage = process_usage();
  run.cpu_seconds = usage.cpu_seconds - cpu_before;
  run.peak_rss_mb = usage.peak_rss_mb;
  warn_of_pieces(slam);
  if (loaded) run.peak_arena_bytes = loaded->network->arena().peak_bytes();
  write_results(out, *dataset, slam, run);
  if (!options.save_map.empty()) slam::write_map(options.save_map, slam.map());
  print_summary(slam_report(run, slam), out);
  if (view && !slam.results().empty()) view->finish(out);
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
  command
      ->add_option("--filter", options->filter,
                   "histogram mismatch filter: votes on how far features moved or, "
                   "compensated, on how far they are from where prediction and depth expect them")
      ->check(CLI::IsMember({"off", "paper", "adaptive", "compensated"}))
      ->capture_default_str();
  command
      ->add_option("--loops", options->loops,
                   "close loops when a place is seen again; recognise: only list such places in run.json")
      ->check(CLI::IsMember({"on", "recognise", "off"}))
      ->capture_default_str();
  command
      ->add_option("--constellation", options->constellation,
                   "with masks: where the same standing objects are around, fewer points prove a place")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--self-calibration", options->self_calibration,
                   "find a constant error of the stereo disparities along with the map")
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
  command->add_flag(std::string("--view{") + kAnyViewPort + "}", options->view,
                    "show the run in a browser on this machine while it goes on, --view=PORT on a port of "
                    "its own (default: "
                    "the first free one from 8080)");
  command->callback([options] { run_slam(*options); });
}

}  // namespace penumbra::apps
