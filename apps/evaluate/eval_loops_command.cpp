// penumbra eval-loops: precision and recall of a run's loops, and of the place index by itself.

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/log.h"
#include "apps/common/run_json.h"
#include "apps/view/loops_report.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/evaluation/loop_evaluation.h"
#include "slam/evaluation/place_index_evaluation.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/map_file.h"

namespace penumbra::apps {

namespace {

using nlohmann::ordered_json;

constexpr const char* kEvalLoopsExamples = R"(Examples:
  penumbra eval-loops out/00 --groundtruth poses/00.txt
  penumbra eval-loops out/00 --groundtruth poses/00.txt --map out/00.map --json

Two frames show the same place where their true positions are within 5 m and their headings within 30 degrees. A
frame revisits a place that was seen at least 50 frames before and left in between. docs/slam/loops.md says how loops
are found, docs/evaluation.md what is counted.)";

struct EvalLoopsOptions {
  std::string run, ground_truth, map;
  slam::RevisitSettings revisits;
  double turn_degrees = 30.0;
  int candidates = 3;
  bool json = false;
};

// A list of whole numbers.
std::vector<int> numbers(const nlohmann::json& list, const std::string& place) {
  if (!list.is_array()) throw InputError(place, "a list of whole numbers", list.dump());
  std::vector<int> numbers;
  for (const nlohmann::json& number : list) {
    if (!number.is_number_integer()) throw InputError(place, "a list of whole numbers", number.dump());
    numbers.push_back(number.get<int>());
  }
  return numbers;
}

// A list of pairs of frames; what follows in an entry is left out.
std::vector<slam::FramePair> pairs(const nlohmann::json& list, const std::string& place) {
  if (!list.is_array()) throw InputError(place, "a list of pairs of frames", list.dump());
  std::vector<slam::FramePair> pairs;
  for (const nlohmann::json& entry : list) {
    const std::vector<int> row = numbers(entry, place);
    if (row.size() < 2) throw InputError(place, "pairs of frames", entry.dump());
    pairs.push_back({row[0], row[1]});
  }
  return pairs;
}

struct Run {
  std::vector<slam::FramePair> loops, covisible, recognised;
  std::vector<int> keyframes;
  std::vector<int> frames;    // numbers of the frames in the sequence ...
  std::vector<double> times;  // ... and their times, seconds
};

Run read_run(const std::filesystem::path& folder) {
  const std::filesystem::path report_path = folder / "run.json", frames_path = folder / "frames.json";
  const nlohmann::json report = read_run_json(report_path), frames = read_run_json(frames_path);
  const auto place = [](const std::filesystem::path& path, const char* key) {
    return fmt::format("{}, '{}'", path.string(), key);
  };
  Run run;
  run.loops = pairs(report.value("loops", nlohmann::json()), place(report_path, "loops"));
  run.covisible = pairs(report.value("covisibility", nlohmann::json()), place(report_path, "covisibility"));
  // Not in the reports of older runs.
  run.recognised = pairs(report.value("recognised_places", nlohmann::json::array()),
                         place(report_path, "recognised_places"));
  run.keyframes =
      numbers(report.value("keyframe_frames", nlohmann::json()), place(report_path, "keyframe_frames"));
  run.frames = numbers(frames.value("index", nlohmann::json()), place(frames_path, "index"));
  const nlohmann::json times = frames.value("timestamp", nlohmann::json());
  const bool has_times = times.is_array() && times.size() == run.frames.size() &&
                         std::all_of(times.begin(), times.end(), [](const auto& t) { return t.is_number(); });
  if (!has_times)
    throw InputError(place(frames_path, "timestamp"), "a time for every frame", "something else");
  run.times = times.get<std::vector<double>>();
  return run;
}

// The true pose of every frame of the run. Of a file without times line i is frame i of the sequence; the
// lines of others are found by the frames' times.
slam::Trajectory true_poses(const EvalLoopsOptions& options, const Run& run) {
  const std::vector<int>& frames = run.frames;
  const slam::TrajectoryFormat format = slam::detect_trajectory_format(options.ground_truth);
  slam::Notes notes;
  const slam::Trajectory all = slam::read_trajectory(options.ground_truth, format, &notes);
  for (const std::string& note : notes) log_warning("{}", note);
  if (!has_times(format)) {
    slam::Trajectory truth;
    for (const int frame : frames) {
      if (frame < 0 || frame >= static_cast<int>(all.size())) {
        throw InputError(options.ground_truth, fmt::format("a pose for frame {}", frame),
                         counted(all.size(), "pose"));
      }
      truth.push_back(all[static_cast<std::size_t>(frame)]);
    }
    return truth;
  }
  slam::Trajectory estimate;
  for (const double time : run.times) estimate.push_back({time, {}});
  slam::TrajectoryPair pair = slam::associate_by_time(all, estimate, 0.05);
  if (pair.reference.size() != frames.size()) {
    throw InputError(options.ground_truth,
                     fmt::format("a pose within 0.05 s of each of {}", counted(frames.size(), "frame")),
                     fmt::format("{}", pair.reference.size()));
  }
  return pair.reference;
}

void run_eval_loops(EvalLoopsOptions options) {
  options.revisits.largest_turn = options.turn_degrees / kDegrees;
  Run run = read_run(options.run);
  const slam::Trajectory truth = true_poses(options, run);
  std::map<int, int> row_of;
  for (std::size_t i = 0; i < run.frames.size(); ++i) row_of[run.frames[i]] = static_cast<int>(i);
  const auto to_row = [&](int& frame) {
    const auto row = row_of.find(frame);
    if (row == row_of.end()) {
      throw InputError(options.run, "frames that frames.json lists", fmt::format("frame {}", frame));
    }
    frame = row->second;
  };
  for (int& frame : run.keyframes) to_row(frame);
  for (std::vector<slam::FramePair>* list : {&run.loops, &run.covisible, &run.recognised}) {
    for (slam::FramePair& pair : *list) {
      to_row(pair.frame);
      to_row(pair.earlier);
    }
  }
  const slam::LoopEvaluation loops =
      slam::evaluate_loops(truth, run.loops, run.keyframes, run.covisible, options.revisits);
  const slam::RecognitionEvaluation recognition =
      slam::evaluate_recognition(truth, run.recognised, run.keyframes, options.revisits);
  std::optional<slam::PlaceIndexEvaluation> index;
  if (!options.map.empty()) {
    const std::unique_ptr<slam::Map> map = slam::read_map(options.map);
    index = slam::evaluate_place_index(*map, truth, run.frames.empty() ? 0 : run.frames.front(), {},
                                       options.candidates, options.revisits);
  }
  if (options.json) {
    ordered_json json = loops_json(loops, run.frames);
    json["recognition"] = recognition_json(recognition);
    if (index) json["place_index"] = index_json(*index);
    fmt::print("{}\n", json.dump(2));
    return;
  }
  print_loops(loops, run.frames);
  print_recognition(recognition);
  if (index) print_index(*index);
}

}  // namespace

void add_eval_loops_command(CLI::App& app) {
  const auto options = std::make_shared<EvalLoopsOptions>();
  CLI::App* command = app.add_subcommand(
      "eval-loops", "Precision and recall of the loops that a run of `penumbra slam` closed");
  command->footer(kEvalLoopsExamples);
  command->add_option("run", options->run, "the --out folder of the run")->required();
  command
      ->add_option("--groundtruth", options->ground_truth,
                   "true poses of the whole sequence, in any format of `penumbra eval`")
      ->required();
  command->add_option("--map", options->map, "the run's saved map: also evaluate the place index by itself");
  command
      ->add_option("--distance", options->revisits.largest_distance,
                   "metres within which a place is the same")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--turn", options->turn_degrees, "degrees within which it is")
      ->check(number_from(0.0, 180.0, "degrees from 0 to 180"))
      ->capture_default_str();
  command
      ->add_option("--frames-apart", options->revisits.fewest_frames_apart,
                   "frames before a place counts as seen again")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--candidates", options->candidates, "of the place index for each keyframe")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_flag("--json", options->json, "print JSON instead of tables");
  command->callback([options] { run_eval_loops(*options); });
}

}  // namespace penumbra::apps
