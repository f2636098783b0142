// penumbra eval-dense: how good the dense map of a run is, where the truth is known.

#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/progress_bar.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/evaluation/dense_evaluation.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/image_list.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::apps {

namespace {

constexpr const char* kEvalDenseExamples = R"(Examples:
  penumbra synth --scene office --preset walking-xyz --sensor rgbd --depth --frames 300 --out out/office
  penumbra slam out/office --dense --masks out/office/instances --out out/office_slam
  penumbra eval-dense out/office_slam --truth out/office

Per voxel of dense.ply the distance to the nearest surface that stands there in truth; which share of those surfaces the
map has; which share of it is left of people and of things that moved. docs/evaluation.md says how it is counted.)";

struct EvalDenseOptions {
  std::string run, truth;
  double farthest = 5.0;  // metres
  int every = 5;          // frames
  bool json = false;
};

// The numbers of people and of things that move.
std::set<int> moving_instances(const std::filesystem::path& path) {
  const nlohmann::json json =
      nlohmann::json::parse(nn::read_text_file(path, "the classes of the instances"), nullptr, false);
  const char* const expected = R"(an object of {"NUMBER": {"class": NAME, "moving": BOOL}})";
  if (!json.is_object()) throw InputError(path.string(), expected, "something else, or a torn file");
  std::set<int> numbers;
  for (const auto& [number, instance] : json.items()) {
    if (!instance.is_object() || number.empty() || number.size() > 5 ||
        number.find_first_not_of("0123456789") != number.npos) {
      throw InputError(fmt::format("{}, \"{}\"", path.string(), number), expected, "something else");
    }
    const nlohmann::json moving = instance.value("moving", nlohmann::json(false));
    const nlohmann::json name = instance.value("class", nlohmann::json());
    if ((moving.is_boolean() && moving.get<bool>()) || name == "person") numbers.insert(std::stoi(number));
  }
  return numbers;
}

// Where the map lies in the world of the truth: as the run's trajectory does.
slam::Similarity place_of_map(const EvalDenseOptions& options) {
  const slam::Trajectory truth =
      slam::read_tum_trajectory(std::filesystem::path(options.truth) / "groundtruth.txt");
  const slam::Trajectory estimate =
      slam::read_tum_trajectory(std::filesystem::path(options.run) / "trajectory_tum.txt");
  const slam::TrajectoryPair pair = slam::associate_by_time(truth, estimate);
  return slam::align_poses(pair.reference, pair.estimate);
}

slam::DenseTruth read_truth(const EvalDenseOptions& options) {
  const std::filesystem::path folder = options.truth;
  const std::set<int> moving = moving_instances(folder / "instances.json");
  const slam::ImageList clean = slam::read_tum_image_list(folder / "depth_clean.txt");
  const std::vector<double> clean_times = slam::times_of(clean.images);
  const std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(folder);
  if (!dataset->ground_truth()) throw InputError(options.truth, "a groundtruth.txt", "none");
  slam::DenseTruth truth;
  ProgressBar progress("Reading the truth", dataset->size());
  std::size_t at = 0, pose = 0;
  for (int i = 0; i < dataset->size(); i += options.every) {
    const slam::StereoImages frame = dataset->load(i);
    const slam::Trajectory& poses = *dataset->ground_truth();
    while (at + 1 < clean_times.size() && clean_times[at] < frame.timestamp - 1e-4) ++at;
    while (pose + 1 < poses.size() && poses[pose].timestamp < frame.timestamp - 1e-4) ++pose;
    const std::string& name = clean.images[at].name;
    const WordImage words = nn::read_depth_image(folder / name, "the true depth, a 16-bit grey PNG");
    const WordImage numbers = nn::read_depth_image(
        folder / "instances" / std::filesystem::path(name).filename(), "instance numbers");
    if (words.size() != frame.depth.size() || numbers.size() != frame.depth.size()) {
      throw InputError(
          (folder / name).string(),
          fmt::format("{}x{} pixels, also of its instances", frame.depth.width(), frame.depth.height()),
          fmt::format("{}x{} and {}x{}", words.width(), words.height(), numbers.width(), numbers.height()));
    }
    FloatImage depth(words.width(), words.height());
    ByteImage moves(words.width(), words.height());
    constexpr float kUnits = 5000.0F;  // a metre, as TUM's depth
    for (int v = 0; v < words.height(); ++v) {
      for (int u = 0; u < words.width(); ++u) {
        depth.at(u, v) = static_cast<float>(words.at(u, v)) / kUnits;
        moves.at(u, v) = moving.contains(numbers.at(u, v)) ? 255 : 0;
      }
    }
    truth.add(dataset->camera(), poses[pose].T_wc, depth, moves, frame.depth, options.farthest);
    progress.update(i + 1);
  }
  return truth;
}

void run_eval_dense(const EvalDenseOptions& options) {
  const slam::DenseCloud map = slam::read_dense_ply(std::filesystem::path(options.run) / "dense.ply");
  const slam::DenseTruth truth = read_truth(options);
  const slam::DenseScore score = truth.score(map, place_of_map(options));
  if (options.json) {
    nlohmann::ordered_json json;
    json["voxels"] = score.voxels;
    json["truth_voxels"] = score.truth_voxels;
    json["median_error_m"] = score.median_error;
    json["p95_error_m"] = score.p95_error;
    json["median_error_at_3m_m"] = score.median_error_at_3m;
    json["completeness"] = score.completeness;
    json["ghosts"] = score.ghosts;
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{} voxels; median error {:.1f} mm, at 3 m {:.1f} mm, 95 % below {:.1f} mm\n", score.voxels,
             1e3 * score.median_error, 1e3 * score.median_error_at_3m, 1e3 * score.p95_error);
  fmt::print("complete to {:.1f} % of what was measured; {:.3f} % of it left of what moved\n",
             100.0 * score.completeness, 100.0 * score.ghosts);
}

}  // namespace

void add_eval_dense_command(CLI::App& app) {
  const auto options = std::make_shared<EvalDenseOptions>();
  CLI::App* command =
      app.add_subcommand("eval-dense", "Compare a run's dense map with the truth of a made office");
  command->footer(kEvalDenseExamples);
  command->add_option("run", options->run, "folder that `penumbra slam --dense --out` wrote")->required();
  command->add_option("--truth", options->truth, "the recording, from `penumbra synth --depth`")
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
