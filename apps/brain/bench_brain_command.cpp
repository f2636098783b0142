// penumbra bench brain: the brain-inspired SLAM beside odometry alone and RatSLAM's templates.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/brain/brain_rows.h"
#include "apps/brain/landmark_finder.h"
#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/parallel.h"
#include "slam/brain/motion/odometry_noise.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::apps {

namespace {

struct BenchBrainOptions {
  std::vector<std::string> recordings;
  std::vector<std::string> rows = brain_row_names();
  std::vector<std::uint64_t> seeds = {900, 901, 902};
  std::string noise = "noisy";
  std::filesystem::path weights, out;
};

// The last part of a path that may end with a slash.
std::string name_of_folder(const std::filesystem::path& folder) {
  const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
  return (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
}

std::string table_of(const nlohmann::json& rows) {
  std::string table =
      "| recording | seed | row | ATE m | t_rel % | r_rel deg/100 m | recalls | precision | recall | nodes | "
      "map "
      "MB | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  // Of nothing that was recalled, or to be, there is no share.
  const auto percent = [](const nlohmann::json& row, const char* share, const char* of) {
    return row[of].get<int>() > 0 ? fmt::format("{:.1f}", 100.0 * row[share].get<double>())
                                  : std::string("-");
  };
  for (const nlohmann::json& row : rows) {
    table += fmt::format(
        "| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {} | {} | {} | {} | {:.1f} | {:.2f} |\n",
        row["recording"].get<std::string>(), row["seed"].get<std::uint64_t>(), row["name"].get<std::string>(),
        row["ate_m"].get<double>(), row["rpe_percent"].get<double>(), row["rpe_deg_per_100m"].get<double>(),
        row["recalls"].get<int>(), percent(row, "precision", "recalls"), percent(row, "recall", "revisits"),
        row["nodes"].get<int>(), row["map_mb"].get<double>(), row["ms"].get<double>());
  }
  return table;
}

void run_bench_brain(const BenchBrainOptions& options) {
  std::vector<BrainRow> rows;
  for (const std::string& name : options.rows) {
    rows.push_back(brain_row(name));
    rows.back().settings.threads = thread_count();
  }
  slam::brain::LandmarkFinder finder;
  if (std::any_of(rows.begin(), rows.end(), [](const BrainRow& row) {
        return row.settings.templates == slam::brain::TemplateKind::landmarks && row.settings.recall;
      }))
    finder = make_landmark_finder(options.weights);
  const slam::brain::OdometryNoise noise = slam::brain::odometry_noise(options.noise);
  if (!options.out.empty()) nn::make_writable_folder(options.out);
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& folder : options.recordings) {
    const std::unique_ptr<slam::StereoDataset> dataset = slam::open_dataset(folder, {});
    for (const std::uint64_t seed : options.seeds) {
      std::filesystem::path pictures;
      if (!options.out.empty()) pictures = options.out / fmt::format("{}-{}", name_of_folder(folder), seed);
      for (nlohmann::json& row :
           run_brain_rows(*dataset, rows, noise, seed, finder, dataset->name(), pictures)) {
        row["recording"] = dataset->name();
        row["seed"] = seed;
        all.push_back(std::move(row));
      }
    }
  }
  const std::string table = table_of(all);
  if (!options.out.empty()) {
    nn::write_file(options.out / "brain.md", table);
    nn::write_file(options.out / "brain.json", all.dump(2) + "\n");
  }
  fmt::print("{}", table);
}

}  // namespace

void add_brain_benchmark(CLI::App& bench) {
  const auto options = std::make_shared<BenchBrainOptions>();
  CLI::App* command =
      bench.add_subcommand("brain", "The brain-inspired SLAM: loops, accuracy, time and memory");
  command->add_option("recordings", options->recordings, "folders of recordings with ground truth")
      ->required();
  command->add_option("--rows", options->rows, "what is compared")->delimiter(',')->capture_default_str();
  command->add_option("--seeds", options->seeds, "of the odometry's noise")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--noise", options->noise, "of the odometry: none, noisy or rough")
      ->capture_default_str();
  add_interest_weights_option(command, options->weights);
  add_threads_option(command);
  command->add_option("--out", options->out, "folder for the results")->type_name("DIR");
  command->footer(
      "Examples:\n"
      "  penumbra bench brain out/street --out out/bench_brain\n"
      "  penumbra bench brain out/street --rows ratslam,intensity-geometry --noise rough --seeds 1,2\n"
      "Rows: odometry (no place is recalled), ratslam, no-interest (each landmark counts the same), "
      "no-sharpness, ours,\n"
      "slam (the geometric one, which takes no odometry), and intensity-geometry: ours with RatSLAM's "
      "templates. Prints\n"
      "and writes a table (brain.md), all figures (brain.json), and for each run of a row but slam the "
      "pictures of\n"
      "`penumbra brain` in RECORDING-SEED/ROW.");
  command->callback([options] { run_bench_brain(*options); });
}

}  // namespace penumbra::apps
