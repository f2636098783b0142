// penumbra bench dynamics: every way to deal with people, on the office, with tables, plots and pictures.
#include <fmt/core.h>

#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/commands.h"
#include "apps/slam/ablation_cells.h"
#include "apps/slam/ablation_tables.h"
#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

struct BenchDynamicsOptions {
  std::filesystem::path out;
  std::vector<std::string> presets = {"walking-xyz",        "walking-static", "walking-rpy",
                                      "walking-halfsphere", "sitting-static", "sitting-xyz"};
  std::vector<std::string> weights;
  std::vector<int> seeds = {900};
  int frames = 150, runs = 0;
};

// What is compared: nothing left out, all of the boxes, the depth clusters, DBSCAN alone, the constraint
// alone, both in the letter of the paper, both, exact masks.
constexpr MaskSource kWays[] = {MaskSource::none,          MaskSource::boxes,        MaskSource::clusters,
                                MaskSource::dbscan,        MaskSource::static_boxes, MaskSource::static_paper,
                                MaskSource::static_points, MaskSource::truth};

std::vector<AblationCell> list_cells(const BenchDynamicsOptions& options,
                                     const std::vector<NamedWeights>& weights) {
  std::vector<AblationCell> cells;
  for (const std::string& preset : options.presets) {
    for (const MaskSource way : kWays) {
      for (const int seed : options.seeds) {
        AblationCell cell{.preset = preset,
                          .seed = seed,
                          .frames = options.frames,
                          .size = {640, 480},
                          .masks = way,
                          .weights = ""};
        if (!cell.is_office())
          throw UsageError(fmt::format("--presets: '{}' is no preset of the office", preset));
        add_cells(cell, options.runs, weights, cells);
      }
    }
  }
  return cells;
}

// Tables as Markdown has them, one after the other, as HTML.
std::string html_of(const std::string& tables) {
  std::string html;
  std::istringstream lines(tables);
  bool open = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("|-", 0) == 0) continue;  // between the head and the rows
    if (line.empty()) {
      if (std::exchange(open, false)) html += "</table>\n";
      continue;
    }
    const char* cell = open ? "td" : "th";
    html += open ? "<tr>" : "<table><tr>";
    open = true;
    for (std::size_t begin = 1, end; (end = line.find('|', begin)) != line.npos; begin = end + 1)
      html += fmt::format("<{0}>{1}</{0}>", cell, line.substr(begin, end - begin));
    html += "</tr>\n";
  }
  return open ? html + "</table>\n" : html;
}

// A page with the table, and each cell's path and features; pictures stay in their files.
std::string page_of(const std::vector<AblationCell>& cells, const std::string& table) {
  std::string page = R"(<!doctype html>
<meta charset="utf-8">
<title>Penumbra: dynamics</title>
<style>
body { font: 15px sans-serif; max-width: 1300px; margin: 2em auto; }
table { border-collapse: collapse; margin: 1em 0; }
td, th { padding: 2px 8px; border-bottom: 1px solid #ccc; text-align: left; }
figure { display: inline-block; margin: 8px; width: 610px; vertical-align: top; }
img { max-width: 100%; }
figcaption { font-weight: bold; }
</style>
<h1>People before the camera</h1>
<p>Each row is a preset and what leaves moving points out: dbscan, the clusters in people's boxes alone;
static-boxes, the static-point constraint alone; static-paper, both as the paper writes them; static-points,
both with the project's own thresholds.</p>
<p>Paths against the true ones, from above. Features of the frame, of the second half's, with the most on people:
green, of the map; red, left out; yellow, others.</p>
)" + html_of(table);
  for (const AblationCell& cell : cells) {
    page += fmt::format(
        "<figure><figcaption>{0}</figcaption><img src=\"cells/{0}.svg\" alt=\"path\"><img "
        "src=\"cells/{0}.png\" alt=\"features\"></figure>\n",
        cell.name());
  }
  return page;
}

void run_bench_dynamics(const BenchDynamicsOptions& options) {
  const std::vector<NamedWeights> weights = named_weights(options.weights);
  const std::vector<AblationCell> cells = list_cells(options, weights);
  const nlohmann::json rows = run_cells("Dynamics", cells, options.out, weights);
  const std::string table = format_dynamics_table(rows) + "\n" + format_office_table(rows);
  nn::write_file(options.out / "dynamics.md", table);
  nn::write_file(options.out / "dynamics.json", rows.dump(2) + "\n");
  nn::write_file(options.out / "dynamics.html", page_of(cells, table));
  fmt::print("{}", table);
}

}  // namespace

void add_dynamics_benchmark(CLI::App& bench) {
  const auto options = std::make_shared<BenchDynamicsOptions>();
  CLI::App* command =
      bench.add_subcommand("dynamics", "Ways to leave out people, on synthetic offices: accuracy and time");
  command->footer(R"(Examples:
  penumbra bench dynamics --weights weights_tools/models/penumbra-office.safetensors --out out/dynamics
  penumbra bench dynamics --presets sitting-xyz --seeds 900,901 --frames 90 --out out/exact

Without --weights boxes are those of exact masks. Writes dynamics.md, dynamics.json and dynamics.html, a page with each path and
what became of the features. Cells that are in the --out folder already are not run again. docs/dynamics/static-points.md.)");
  command->add_option("--out", options->out, "folder for recordings and results")
      ->required()
      ->type_name("DIR");
  command->add_option("--presets", options->presets, "of the office")->delimiter(',')->capture_default_str();
  command->add_option("--weights", options->weights, "detectors, NAME=FILE or FILE")->delimiter(',');
  command->add_option("--seeds", options->seeds, "of the office")->delimiter(',')->capture_default_str();
  command->add_option("--frames", options->frames, "of each recording")
      ->check(CLI::Range(2, 20000))
      ->capture_default_str();
  add_runs_option(command, options->runs);
  command->callback([options] { run_bench_dynamics(*options); });
}

}  // namespace penumbra::apps
