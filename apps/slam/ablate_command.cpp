// penumbra ablate: what the semantics are worth, measured on synthetic drives.
#include <fmt/core.h>

#include <memory>

#include "apps/common/commands.h"
#include "apps/common/image_size.h"
#include "apps/slam/ablation_cells.h"
#include "apps/slam/ablation_tables.h"
#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

struct AblateOptions {
  std::filesystem::path out;
  std::vector<std::string> presets = {"easy", "street", "crowded"};
  std::vector<std::string> masks = {"none", "movers", "truth"};
  std::vector<std::string> filters = {"adaptive"};
  std::vector<std::string> weights;  // NAME=FILE or FILE
  std::vector<int> seeds = {1, 2, 3};
  int frames = 470;
  std::string size;  // empty: 620x188 of the street, 640x480 of the office
  std::string segmentation = "keyframes";
  int runs = 0;
  bool json = false;
};

Size drive_size(const std::string& text) {
  const std::optional<Size> size = parse_image_size(text);
  if (size && size->width >= 64 && size->height >= 48) return *size;
  throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT such as 620x188, found '{}'", text));
}

std::vector<AblationCell> list_cells(const AblateOptions& options, const std::vector<NamedWeights>& weights) {
  std::vector<AblationCell> cells;
  for (const std::string& preset : options.presets) {
    for (const int seed : options.seeds) {
      for (const std::string& masks : options.masks) {
        for (const std::string& filter : options.filters) {
          AblationCell cell{.preset = preset,
                            .seed = seed,
                            .frames = options.frames,
                            .size = {},
                            .masks = parse_mask_source(masks),
                            .weights = "",
                            .filter = filter,
                            .all_frames = options.segmentation == "all"};
          cell.size = drive_size(!options.size.empty() ? options.size
                                 : cell.is_office()    ? "640x480"
                                                       : "620x188");
          add_cells(cell, options.runs, weights, cells);
        }
      }
    }
  }
  return cells;
}

void run_ablate(const AblateOptions& options) {
  const std::vector<NamedWeights> weights = named_weights(options.weights);
  const std::vector<AblationCell> cells = list_cells(options, weights);
  const nlohmann::json rows = run_cells("Ablation", cells, options.out, weights);
  const std::string office = format_office_table(rows);
  const std::string table = format_table(rows) + (office.empty() ? "" : "\n" + office);
  nn::write_file(options.out / "ablation.md", table);
  nn::write_file(options.out / "ablation.json", rows.dump(2) + "\n");
  fmt::print("{}", options.json ? rows.dump(2) + "\n" : table);
}

}  // namespace

void add_ablate_command(CLI::App& app) {
  const auto options = std::make_shared<AblateOptions>();
  CLI::App* command = app.add_subcommand(
      "ablate", "Measure what masks and filters are worth, on synthetic drives and offices");
  command->footer(R"(Examples:
  penumbra ablate --out out/ablation
  penumbra ablate --presets lorry,lorry-close --frames 200 --masks none,movers,truth --out out/lorry
  penumbra ablate --masks classes,geometry --weights mam=mam.safetensors,fpn=fpn.safetensors --out out/networks

  penumbra ablate --presets walking-xyz,sitting-xyz --masks none,boxes,clusters,truth --frames 150 --out out/people
  penumbra ablate --presets walking-static --masks clusters --runs 10 --frames 150 --seeds 1 --out out/ten

Cells that are in the --out folder already are not run again. Writes ablation.md and ablation.json.)");
  command->add_option("--out", options->out, "folder for drives and results")->required()->type_name("DIR");
  const auto list = [&](const char* name, auto& value, const char* help) {
    command->add_option(name, value, help)->delimiter(',')->capture_default_str();
  };
  list("--presets", options->presets,
       "of the street: easy, street, crowded, lorry, lorry-close; of the office: those of `penumbra synth`");
  list("--masks", options->masks,
       "none; movers (no masks, geometry alone); classes, geometry (by the networks); of RGB-D boxes, "
       "clusters-unrepaired, clusters, clusters-consistent, dbscan, static-boxes, static-paper, "
       "static-points (by the networks' boxes, or exact ones); static-masks (exact masks, and points given "
       "back); truth (exact masks)");
  list("--filters", options->filters, "mismatch filters: off, paper, adaptive, compensated");
  list("--weights", options->weights, "networks, NAME=FILE or FILE");
  list("--seeds", options->seeds, "of the street");
  command->add_option("--frames", options->frames, "of each drive; 401 are once round the block")
      ->check(CLI::Range(2, 20000))
      ->capture_default_str();
  command
      ->add_option("--size", options->size, "of the images, pixels (default: 620x188, of the office 640x480)")
      ->type_name("WxH");
  command->add_option("--segmentation", options->segmentation, "frames that are segmented")
      ->check(CLI::IsMember({"keyframes", "all"}))
      ->capture_default_str();
  add_runs_option(command, options->runs);
  command->add_flag("--json", options->json, "the table as JSON on stdout");
  command->callback([options] { run_ablate(*options); });
}

}  // namespace penumbra::apps
