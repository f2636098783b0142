#include "apps/slam/slam_run.h"

#include <fmt/core.h>
#include <malloc.h>

#include <charconv>
#include <memory>

#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "apps/common/process_usage.h"
#include "apps/network/load_network.h"
#include "apps/slam/frame_input.h"
#include "apps/slam/frame_loop.h"
#include "apps/slam/segmenter.h"
#include "apps/slam/semantics_options.h"
#include "apps/slam/slam_results.h"
#include "apps/view/live_view.h"
#include "apps/view/processor_times.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "slam/map/map_file.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/pipeline/recorder.h"
#include "slam/pipeline/setting_fields.h"
#include "slam/pipeline/settings_file.h"
#include "slam/pipeline/slam.h"

namespace penumbra::apps {

namespace {

// Empty where no segmentation by a network is asked for.
std::optional<LoadedNetwork> find_network(const SlamOptions& options,
                                          const slam::SemanticsSettings& semantics) {
  if (semantics.mode == slam::SegmentationMode::off || options.weights.empty()) return std::nullopt;
  return load_network(options.weights, options.classes, slam_network_config(), options.key);
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

// What is of four megabytes and more (an adjustment of the whole map) goes back to the system when it is
// freed; what is smaller (a frame's images and patches) stays, to be used again without a page fault.
void set_up_memory() {
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  mallopt(M_TRIM_THRESHOLD, 32 << 20);
}

// The map of --load-map; nothing where none is asked for.
std::unique_ptr<slam::Map> load_map(const SlamOptions& options, const slam::StereoCamera& camera) {
  if (options.load_map.empty()) return nullptr;
  std::unique_ptr<slam::Map> map = slam::read_map(options.load_map);
  slam::require_same_camera(map->camera(), camera, options.load_map);
  return map;
}

// Throws Error where the run was stopped, or located nothing, or fewer frames than are asked for. What it
// says is the last line.
void judge(const SlamOptions& options, const slam::Recorder& record, const SlamRun& run) {
  if (!run.error.empty()) throw Error(run.error);
  if (record.frames().empty()) throw Error("the recording ended before its first whole frame");
  const double share = record.tracked() / static_cast<double>(record.frames().size());
  if (share < options.require_tracked) {
    throw Error(
        fmt::format("{}. --require-tracked asks for {:g} %", run.why_lost, 100.0 * options.require_tracked));
  }
  if (record.tracked() == 0) throw Error(run.why_lost);
  if (!run.why_lost.empty()) log_warning("{}", run.why_lost);
}

}  // namespace

slam::SlamSettings make_settings(const SlamOptions& options) {
  slam::SlamSettings settings;
  settings.deterministic = false;
  settings.threads = options.threads;
  if (!options.settings.empty()) slam::read_settings(options.settings, settings);
  const auto says = [&](const char* name) { return has_a_say(options, name); };
  if (says("--features")) settings.orb.features = options.features;
  if (says("--filter")) settings.tracker.mismatch_filter.mode = slam::mismatch_filter_mode(options.filter);
  if (says("--loops")) {
    settings.loops.enabled = options.loops != "off";
    settings.loops.corrects = options.loops == "on";
  }
  if (says("--constellation")) settings.loops.verifier.constellation.enabled = options.constellation == "on";
  if (options.self_calibration == "off") settings.full_bundle.disparity_offset_sigma = 0.0;
  if (says("--least-sharpness")) settings.tracker.least_sharpness = options.least_sharpness;
  set_semantics(options, settings.semantics);
  if (says("--movers")) {
    settings.semantics.rigid_mover.enabled = settings.semantics.instances.companions.enabled =
        options.movers == "on";
  }
  if (says("--localise")) settings.localise = options.localise;
  if (says("--threads")) settings.threads = options.threads;
  if (says("--segmentation-threads")) settings.semantics.threads = options.segmentation_threads;
  if (says("--grid-resolution")) settings.dense.plan.cell = options.grid_resolution;
  if (says("--deterministic")) settings.deterministic = options.deterministic;
  return settings;
}

void run_slam(const SlamOptions& options) {
  set_up_memory();
  const std::optional<int> port = view_port(options.view);
  slam::SlamSettings settings = make_settings(options);

  SlamRun run;
  FrameInput input(options);
  const slam::StereoDataset& dataset = input.dataset();
  run.dataset = dataset.name();
  for (const std::string& note : dataset.notes()) log_warning("{}: {}", options.dataset.folder, note);
  run.warnings = dataset.notes();
  if (options.given.contains("--body")) {
    run.body = slam::mounting_of(options.body, dataset.mountings(), "--body: " + options.dataset.folder);
    log_info("{}", body_text(*run.body));
  }
  const std::optional<LoadedNetwork> loaded = find_network(options, settings.semantics);
  if (loaded && !options.least_score && options.settings.empty())
    settings.semantics.instances.least_score = least_score_of(*loaded);
  slam::Segmenter segmenter;
  check_semantics(options, dataset, settings.semantics);
  if (loaded) segmenter = make_segmenter(*loaded, dataset.camera(), settings.semantics);
  if (!options.masks.empty() && settings.semantics.mode != slam::SegmentationMode::off)
    segmenter = make_segmenter(options.masks, dataset.camera(), settings.semantics);
  run.segmentation = segmenter ? segmentation_text(settings.semantics) : "off";
  std::unique_ptr<slam::Map> map = load_map(options, dataset.camera());
  const ResultPlaces places{options.out, options.save_map};
  prepare_places(places);

  set_thread_count(settings.threads);
  slam::Slam slam(dataset.camera(), dataset.sensor(), settings, segmenter, std::move(map));
  slam::Recorder record(slam, places.out);
  std::optional<LiveView> view;
  if (!options.view.empty()) {
    view.emplace(port, run, dataset.size(), record);
    log_info("watch it on {}", view->address());
  }
  const Interruption interruption;  // until the results are written
  const double cpu_before = process_usage().cpu_seconds;
  slam::DenseMapper dense(slam.settings().dense);
  FrameLoop(options, input, slam, record, options.dense ? &dense : nullptr, view ? &*view : nullptr, run)
      .run(places);
  record.finish();
  input.tell(run);
  const ProcessUsage usage = process_usage();
  run.finished = true;
  if (segmenter && record.instances().empty()) {
    run.warnings.push_back(fmt::format("no object was found with a score of {:g} or more (--least-score)",
                                       settings.semantics.instances.least_score));
    log_warning("{}", run.warnings.back());
  }
  warn_of_late_masks(record, run);
  run.cpu_seconds = usage.cpu_seconds - cpu_before;
  run.peak_rss_mb = usage.peak_rss_mb;
  warn_of_pieces(record);
  if (loaded) run.peak_arena_bytes = loaded->network->arena().peak_bytes();
  write_results(places, dataset, record, options.dense ? &dense : nullptr, run);
  const nlohmann::json report = slam_report(run, record);
  if (options.profile) fmt::print("{}", processor_table(report["processor_ms"]));
  print_summary(report, places.out);
  if (view && !record.frames().empty()) view->finish(places.out);
  judge(options, record, run);
}

}  // namespace penumbra::apps
