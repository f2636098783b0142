#include "apps/slam/ablation_cells.h"

#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "apps/slam/ablation_tables.h"
#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

// The file of the cell's network; empty: it has none.
std::string weights_of(const AblationCell& cell, const std::vector<NamedWeights>& weights) {
  for (const NamedWeights& network : weights) {
    if (network.name == cell.weights) return network.file;
  }
  return {};
}

// Makes the folders below `out`; throws Error where they cannot be made.
void prepare_cells(const std::filesystem::path& out) {
  for (const char* folder : {"cells", "drives"}) {
    std::error_code error;
    std::filesystem::create_directories(out / folder, error);
    if (error) throw Error(fmt::format("{}: cannot be made: {}", (out / folder).string(), error.message()));
  }
}

// The cell's result, from its file where it has one.
nlohmann::json result_of(const AblationCell& cell, const std::filesystem::path& out,
                         const std::vector<NamedWeights>& weights) {
  const std::filesystem::path file = out / "cells" / (cell.name() + ".json");
  if (std::filesystem::exists(file)) {
    nlohmann::json known = nlohmann::json::parse(nn::read_file(file, "a cell"), nullptr, false);
    if (known.is_object()) return known;
  }
  const std::filesystem::path drive = render_drive(cell, out / "drives");
  nlohmann::json result = run_cell(cell, drive, weights_of(cell, weights), out / "cells");
  result["preset"] = cell.preset;
  result["seed"] = cell.seed;
  result["frames"] = cell.frames;
  result["masks"] = name_of(cell.masks);
  result["weights"] = cell.weights;
  result["filter"] = cell.filter;
  result["office"] = cell.is_office();
  result["all_frames"] = cell.all_frames;
  result["run"] = cell.run;
  nn::write_file(file, result.dump(2) + "\n");
  return result;
}

}  // namespace

std::vector<NamedWeights> named_weights(const std::vector<std::string>& texts) {
  std::vector<NamedWeights> weights;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == text.npos) {
      weights.push_back({std::filesystem::path(text).stem().string(), text});
    } else {
      weights.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (weights[i].name == weights[j].name)
        throw UsageError(
            fmt::format("--weights: two networks named '{}'; name them, NAME=FILE", weights[i].name));
    }
  }
  return weights;
}

void add_cells(AblationCell cell, int runs, const std::vector<NamedWeights>& weights,
               std::vector<AblationCell>& cells) {
  const bool by_network = cell.masks == MaskSource::classes || cell.masks == MaskSource::geometry;
  const bool by_either = cell.masks != MaskSource::none && cell.masks != MaskSource::movers &&
                         cell.masks != MaskSource::truth &&
                         cell.masks != MaskSource::static_masks;  // a network's, or exact ones
  if (by_network && weights.empty())
    throw UsageError(fmt::format("--masks {}: needs --weights", name_of(cell.masks)));
  for (cell.run = runs > 0 ? 1 : 0; cell.run <= runs; ++cell.run) {
    if (!by_either || weights.empty()) {
      cells.push_back(cell);
      continue;
    }
    for (const NamedWeights& network : weights) {
      cells.push_back(cell);
      cells.back().weights = network.name;
    }
  }
}

nlohmann::json run_cells(const std::string& title, const std::vector<AblationCell>& cells,
                         const std::filesystem::path& out, const std::vector<NamedWeights>& weights) {
  prepare_cells(out);
  nlohmann::json results = nlohmann::json::array();
  ProgressBar progress(title, static_cast<int>(cells.size()), "cells");
  for (const AblationCell& cell : cells) {
    results.push_back(result_of(cell, out, weights));
    log_info("{}: ATE {:.4f} m", cell.name(), results.back()["ate_m"].get<double>());
    progress.update(static_cast<int>(results.size()));
  }
  return summarise_cells(results);
}

void add_runs_option(CLI::App* command, int& runs) {
  command
      ->add_option("--runs", runs, "run each cell so often with all threads (default: once, deterministic)")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
}

}  // namespace penumbra::apps
