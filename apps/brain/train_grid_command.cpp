// penumbra brain train-grid: lets grid cells learn on a random walk, and measures what they have learned.
#include <fmt/core.h>

#include <memory>
#include <numbers>

#include "apps/brain/grid_pictures.h"
#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/progress_bar.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/brain/position/grid_file.h"
#include "slam/brain/position/grid_training.h"

namespace penumbra::apps {

namespace {

using slam::brain::GridTrainingSettings;
using slam::brain::HeadDirectionRing;
using slam::brain::LahnSettings;

constexpr const char* kExamples = R"(Examples:
  penumbra brain train-grid --out out/grid.safetensors
  penumbra brain train-grid --room L --seed 900 --seeds 20 --modules 3 --out out/L.safetensors
  penumbra brain train-grid --rule paper --seeds 0 --out out/paper.safetensors

Beside FILE.safetensors it writes FILE-maps.jpg (rate maps and their autocorrelograms), FILE-growth.svg (gridness over time, by
the rule that works and by the paper's) and FILE-ring.svg (the head-direction ring), and prints the figures: docs/brain/grid-cells.md
says what they mean.)";

struct TrainGridOptions {
  std::string room = "square", rule = "rectified";
  double seconds = 1000.0;
  std::uint64_t seed = 1;
  int modules = 10, seeds = 1;
  bool boundary_factor = false;
  std::filesystem::path out;
};

GridTrainingSettings settings_of(const TrainGridOptions& options) {
  GridTrainingSettings settings;
  settings.room = slam::brain::parse_room(options.room);
  settings.rule = LahnSettings::of_rule(options.rule);
  settings.seconds = options.seconds;
  settings.seed = options.seed;
  settings.modules = options.modules;
  settings.boundary_factor = options.boundary_factor;
  return settings;
}

// FILE-maps.jpg of FILE.safetensors.
std::filesystem::path beside(const std::filesystem::path& out, const char* ending) {
  return out.parent_path() / (out.stem().string() + ending);
}

void survey(const TrainGridOptions& options, const GridTrainingSettings& settings) {
  std::vector<SurveyRow> rows;
  {
    ProgressBar bar("Measuring", survey_size(options.seeds), "networks");
    rows = survey_grid_cells(settings, options.seeds, [&](int done) { bar.update(done); });
  }
  print_survey(rows);
  nn::write_image(beside(options.out, "-maps.jpg"), draw_rate_maps(rows));
  slam::write_plot(beside(options.out, "-growth.svg"), draw_growth(rows));
  if (options.modules < 3) return;
  const std::vector<double> noises = {0.0, 0.1, 0.3};
  print_decoding(survey_decoding(settings, noises), noises);
}

void run_train_grid(const TrainGridOptions& options) {
  const GridTrainingSettings settings = settings_of(options);
  if (options.out.has_parent_path()) nn::make_writable_folder(options.out.parent_path());
  slam::brain::write_grid_code(options.out, slam::brain::train_grid_code(settings),
                               {{"room", options.room},
                                {"rule", options.rule},
                                {"seconds", fmt::format("{:g}", options.seconds)},
                                {"seed", fmt::format("{}", options.seed)},
                                {"boundary_factor", options.boundary_factor ? "1" : "0"},
                                {"made_by", "penumbra brain train-grid"}});
  const HeadDirectionRing before(settings.ring, settings.seed);
  const HeadDirectionRing after = HeadDirectionRing::trained(settings.ring, settings.seed);
  slam::write_plot(beside(options.out, "-ring.svg"), draw_ring(before, after));
  fmt::print("{} modules of {} cells in {}; head directions uneven by {:.2f} degrees at most\n",
             options.modules, settings.rule.cells, options.out.string(),
             after.unevenness() * 180.0 / std::numbers::pi);
  if (options.seeds > 0) survey(options, settings);
}

}  // namespace

void add_train_grid_command(CLI::App& brain) {
  const auto options = std::make_shared<TrainGridOptions>();
  CLI::App* command = brain.add_subcommand(
      "train-grid", "Let grid cells learn on a random walk through a room; measure and draw what they learn");
  command->footer(kExamples);
  command->add_option("--room", options->room, "where to walk, about 2 m wide")
      ->check(CLI::IsMember({"square", "hexagon", "L"}))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "of the walk, at 0.3 m/s")
      ->check(number_from(1.0, 1e5, "a number from 1 to 100000"))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of the walks, the first weights and the ring")
      ->capture_default_str();
  command->add_option("--rule", options->rule, "of learning; paper: as it is printed, which learns nothing")
      ->check(CLI::IsMember({"rectified", "paper"}))
      ->capture_default_str();
  command->add_option("--modules", options->modules, "networks in the file, each with a walk of its own")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--boundary-factor", options->boundary_factor, "train the file's with walls ahead (R_p)");
  command
      ->add_option("--seeds", options->seeds,
                   "measure the networks of so many seeds from --seed on, by either rule; 0: none")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_option("--out", options->out, "the file to write")->required()->type_name("FILE");
  command->callback([options] { run_train_grid(*options); });
}

}  // namespace penumbra::apps
