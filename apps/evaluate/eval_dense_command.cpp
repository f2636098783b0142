// penumbra eval-dense: how good the dense map of a run is, where the truth is known.

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/made_truth.h"
#include "apps/common/progress_bar.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "slam/evaluation/dense_evaluation.h"
#include "slam/evaluation/plan_evaluation.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::apps {

namespace {

constexpr const char* kEvalDenseExamples = R"(Examples:
  penumbra synth --scene office --preset walking-xyz --frames 300 --out out/office
  penumbra slam out/office --dense --masks out/office/instances --out out/office_slam
  penumbra eval-dense out/office_slam --truth out/office
  penumbra synth --path block --size 1240x376 --out out/street
  penumbra slam out/street --dense --masks out/street/sequences/00/instances --out out/street_slam
  penumbra eval-dense out/street_slam --truth out/street

Of an office, per voxel of dense.ply the distance to the nearest surface that stands there in truth; which share of those
surfaces the map has; which share of it is left of people and of things that moved. Of both, which of the plan's cells are
right. docs/evaluation.md says how it is counted.)";

struct EvalDenseOptions {
  std::string run, truth;
  double farthest = 5.0;  // metres
  int every = 5;          // frames
  bool json = false;
};

// Where the map lies in the world of the truth: as the run's trajectory does.
slam::Similarity place_of_map(const EvalDenseOptions& options) {
  const slam::Trajectory truth =
      slam::read_tum_trajectory(std::filesystem::path(options.truth) / "groundtruth.txt");
  const slam::Trajectory estimate =
      slam::read_tum_trajectory(std::filesystem::path(options.run) / "trajectory_tum.txt");
  const slam::TrajectoryPair pair = slam::associate_by_time(truth, estimate);
  return slam::align_poses(pair.reference, pair.estimate);
}

// What the frame's pixels show, as DenseTruth takes it.
ByteImage kinds_of_pixels(const WordImage& numbers, const std::map<int, MadeInstance>& instances) {
  ByteImage kinds(numbers.width(), numbers.height());
  std::transform(numbers.data(), numbers.data() + numbers.elements(), kinds.data(),
                 [&](std::uint16_t number) {
                   const auto at = instances.find(number);
                   if (at == instances.end()) return slam::DenseTruth::kStands;
                   if (at->second.class_name == "person") return slam::DenseTruth::kPerson;
                   return at->second.moves ? slam::DenseTruth::kThingMoves : slam::DenseTruth::kStands;
                 });
  return kinds;
}

slam::DenseTruth read_truth(const EvalDenseOptions& options) {
  const std::filesystem::path folder = options.truth;
  const std::map<int, MadeInstance> instances = read_instance_list(folder / "instances.json");
  const TrueDepths depths(folder, folder / "depth_clean");
  const std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(folder);
  if (!dataset->ground_truth()) throw InputError(options.truth, "a groundtruth.txt", "none");
  const slam::Trajectory& poses = *dataset->ground_truth();
  if (static_cast<int>(poses.size()) != dataset->size()) {
    throw InputError((folder / "groundtruth.txt").string(),
                     fmt::format("a pose for each of {}", counted(dataset->size(), "frame")),
                     counted(poses.size(), "pose"));
  }
  slam::DenseTruth truth;
  ProgressBar progress("Reading the truth", dataset->size());
  for (int i = 0; i < dataset->size(); i += options.every) {
    const slam::StereoImages frame = dataset->load(i);
    if (!depths.has(frame.index))
      throw InputError((folder / "depth_clean").string(), fmt::format("an image of frame {}", frame.index),
                       "none");
    const FloatImage depth = depths.load(frame.index, frame.depth.size());
    const std::filesystem::path numbers_file = folder / "instances" / depths.file(frame.index).filename();
    const WordImage numbers = nn::read_depth_image(numbers_file, "a 16-bit grey PNG of instance numbers");
    if (numbers.size() != depth.size()) {
      throw InputError(numbers_file.string(), fmt::format("{}x{} pixels", depth.width(), depth.height()),
                       fmt::format("{}x{}", numbers.width(), numbers.height()));
    }
    truth.add(dataset->camera(), poses[static_cast<std::size_t>(i)].T_wc, depth,
              kinds_of_pixels(numbers, instances), frame.depth, options.farthest);
    progress.update(i + 1);
  }
  return truth;
}

// The plan of the truth; nothing where there is none, as in recordings of earlier versions.
std::optional<slam::OccupancyGrid> true_plan(const std::filesystem::path& truth) {
  for (const char* name : {"plan.yaml", "sequences/00/plan.yaml"}) {
    if (std::filesystem::exists(truth / name)) return slam::read_occupancy(truth / name);
  }
  return std::nullopt;
}

void tell(const slam::DenseScore& score) {
  fmt::print("{}; median error {:.1f} mm, at 3 m {:.1f} mm, 95 % below {:.1f} mm\n",
             counted(score.voxels, "voxel"), 1e3 * score.median_error, 1e3 * score.median_error_at_3m,
             1e3 * score.p95_error);
  fmt::print(
      "complete to {:.1f} % of what was measured; {:.3f} % of it left of people, {:.3f} % of things that "
      "moved\n",
      100.0 * score.completeness, 100.0 * score.people, 100.0 * (score.ghosts - score.people));
}

void tell(const slam::PlanScore& score) {
  fmt::print("plan: {:.0f} m2 free, {:.2f} % of them rightly, {:.2f} % but for the rim of obstacles\n",
             score.free_square_metres, 100.0 * score.free_right, 100.0 * score.free_near);
  fmt::print(
      "plan: {:.0f} m2 blocked, {:.2f} % of them within a cell of an obstacle; {:.2f} % of the obstacles "
      "beside free cells are in it\n",
      score.blocked_square_metres, 100.0 * score.blocked_right, 100.0 * score.obstacles);
}

nlohmann::ordered_json json_of(const slam::DenseScore& score) {
  nlohmann::ordered_json json;
  json["voxels"] = score.voxels;
  json["truth_voxels"] = score.truth_voxels;
  json["median_error_m"] = score.median_error;
  json["p95_error_m"] = score.p95_error;
  json["median_error_at_3m_m"] = score.median_error_at_3m;
  json["completeness"] = score.completeness;
  json["ghosts"] = score.ghosts;
  json["people"] = score.people;
  return json;
}

nlohmann::ordered_json json_of(const slam::PlanScore& score) {
  return {{"free_m2", score.free_square_metres},          {"free_right", score.free_right},
          {"free_but_for_rims", score.free_near},         {"blocked_m2", score.blocked_square_metres},
          {"blocked_within_a_cell", score.blocked_right}, {"obstacles_within_a_cell", score.obstacles}};
}

void run_eval_dense(const EvalDenseOptions& options) {
  const std::filesystem::path run = options.run, truth = options.truth;
  std::optional<slam::DenseScore> voxels;
  if (!std::filesystem::is_directory(truth / "sequences")) {  // of stereo drives the plan is judged alone
    const slam::DenseCloud map = slam::read_dense_ply(run / "dense.ply");
    voxels = read_truth(options).score(map, place_of_map(options));
  }
  std::optional<slam::PlanScore> plan;
  const std::optional<slam::OccupancyGrid> cells = true_plan(truth);
  if (cells && std::filesystem::exists(run / "plan.yaml"))
    plan = slam::score_plan(slam::read_occupancy(run / "plan.yaml"), *cells);
  if (!voxels && !plan) {
    throw InputError(cells ? options.run : options.truth,
                     "plan.yaml, as `penumbra slam --dense` and `penumbra synth` write it", "none");
  }
  if (options.json) {
    nlohmann::ordered_json json = voxels ? json_of(*voxels) : nlohmann::ordered_json::object();
    if (plan) json["plan"] = json_of(*plan);
    fmt::print("{}\n", json.dump(2));
    return;
  }
  if (voxels) tell(*voxels);
  if (plan) tell(*plan);
}

}  // namespace

void add_eval_dense_command(CLI::App& app) {
  const auto options = std::make_shared<EvalDenseOptions>();
  CLI::App* command = app.add_subcommand(
      "eval-dense", "Compare a run's dense map and plan with the truth of a made recording");
  command->footer(kEvalDenseExamples);
  command->add_option("run", options->run, "folder that `penumbra slam --dense --out` wrote")->required();
  command->add_option("--truth", options->truth, "the recording, from `penumbra synth`")
      ->required()
      ->type_name("DIR");
  command->add_option("--farthest", options->farthest, "metres from a camera beyond which nothing counts")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--every", options->every, "every how many frames of the truth are taken")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--json", options->json, "print the figures as JSON");
  command->callback([options] { run_eval_dense(*options); });
}

}  // namespace penumbra::apps
