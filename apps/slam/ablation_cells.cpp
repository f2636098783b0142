#include "apps/slam/ablation_cells.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "apps/slam/ablation_tables.h"
#include "nn/base/crc32.h"
#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::apps {

namespace {

// The cell's network; without a name: it has none.
NamedWeights weights_of(const AblationCell& cell, const std::vector<NamedWeights>& weights) {
  for (const NamedWeights& network : weights) {
    if (network.name == cell.weights) return network;
  }
  return {};
}

// What a result says of the cell that it belongs to.
nlohmann::json identity_of(const AblationCell& cell, const NamedWeights& network) {
  nlohmann::json identity = {{"preset", cell.preset},
                             {"seed", cell.seed},
                             {"frames", cell.frames},
                             {"masks", name_of(cell.masks)},
                             {"weights", cell.weights},
                             {"filter", cell.filter},
                             {"office", cell.is_office()},
                             {"all_frames", cell.all_frames},
                             {"run", cell.run}};
  if (!network.content.empty()) identity["weights_content"] = network.content;
  return identity;
}

// Whether `known`, from a file, is the whole result of that cell.
bool is_result_of(const nlohmann::json& known, const nlohmann::json& identity) {
  if (!known.is_object()) return false;
  for (const auto& [key, value] : identity.items()) {
    if (!known.contains(key) || known[key] != value) return false;
  }
  constexpr const char* kFigures[] = {"ate_m",       "rpe_m", "angle_deg", "loops",    "loop_precision",
                                      "loop_recall", "lost",  "occluded",  "median_ms"};
  return std::all_of(std::begin(kFigures), std::end(kFigures),
                     [&](const char* figure) { return known.contains(figure) && known[figure].is_number(); });
}

// The cell's result, from its file where it has one.
nlohmann::json result_of(const AblationCell& cell, const std::filesystem::path& out,
                         const std::vector<NamedWeights>& weights) {
  const NamedWeights network = weights_of(cell, weights);
  const nlohmann::json identity = identity_of(cell, network);
  const std::filesystem::path file = out / "cells" / (cell.name() + ".json");
  if (std::filesystem::exists(file)) {
    nlohmann::json known = nlohmann::json::parse(nn::read_file(file, "a cell's result"), nullptr, false);
    if (is_result_of(known, identity)) return known;
    log_info("{}: not this cell's whole result, made anew", file.string());
  }
  const std::filesystem::path drive = render_drive(cell, out / "drives");
  nlohmann::json result = run_cell(cell, drive, network.file, out / "cells");
  result.update(identity);
  nn::write_file(file, result.dump(2) + "\n");
  return result;
}

}  // namespace

std::vector<NamedWeights> named_weights(const std::vector<std::string>& texts) {
  constexpr const char* kNameCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-";
  std::vector<NamedWeights> weights;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    NamedWeights network;
    network.file = equals == text.npos ? text : text.substr(equals + 1);
    network.name = equals == text.npos ? std::filesystem::path(text).stem().string() : text.substr(0, equals);
    if (network.name.empty() || network.name.find_first_not_of(kNameCharacters) != network.name.npos) {
      throw UsageError(
          fmt::format("--weights: expected a name of letters, digits, '.', '_', '+' and '-', found '{}'; "
                      "name them, NAME=FILE",
                      network.name));
    }
    const std::string bytes = nn::read_file(network.file, "weights");
    network.content = fmt::format("{} bytes, CRC-32 {:08x}", bytes.size(), nn::crc32(bytes));
    weights.push_back(std::move(network));
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
  for (const char* folder : {"cells", "drives"}) nn::make_writable_folder(out / folder);
  std::set<std::string> without_truth;  // recordings
  nlohmann::json results = nlohmann::json::array();
  ProgressBar progress(title, static_cast<int>(cells.size()), "cells");
  for (const AblationCell& cell : cells) {
    results.push_back(result_of(cell, out, weights));
    if (cell.is_office() && !results.back().contains("moving_recall") &&
        without_truth.insert(cell.drive_name()).second) {
      log_warning(
          "{}: no flow, no true depth or no instances, so what became of its points stays empty; remove the "
          "folder and "
          "its cells to have them made anew",
          (out / "drives" / cell.drive_name()).string());
    }
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
