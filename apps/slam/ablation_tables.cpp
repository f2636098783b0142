#include "apps/slam/ablation_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace penumbra::apps {

namespace {

// "mean" or "std" of a figure; not a number where the row has none.
double figure(const nlohmann::json& row, const std::string& key, const char* which = "mean") {
  return row.contains(key) ? row[key][which].get<double>() : std::nan("");
}

// What the masks are, and whose.
std::string masks_of(const nlohmann::json& row) {
  const std::string masks = row["masks"].get<std::string>(), weights = row["weights"].get<std::string>();
  return weights.empty() ? masks : fmt::format("{} ({})", masks, weights);
}

}  // namespace

nlohmann::json summarise_cells(const nlohmann::json& cells) {
  std::map<std::string, std::size_t> row_of;
  nlohmann::json rows = nlohmann::json::array();
  std::vector<std::map<std::string, std::vector<double>>> values;
  for (const nlohmann::json& cell : cells) {
    const std::string key =
        fmt::format("{} {} {} {} {}", cell.at("preset").get<std::string>(),
                    cell.at("masks").get<std::string>(), cell.at("weights").get<std::string>(),
                    cell.at("filter").get<std::string>(), cell.value("all_frames", false));
    const auto [at, added] = row_of.emplace(key, rows.size());
    if (added) {
      rows.push_back({{"preset", cell["preset"]},
                      {"masks", cell["masks"]},
                      {"weights", cell["weights"]},
                      {"filter", cell["filter"]},
                      {"office", cell.value("office", false)},
                      {"all_frames", cell.value("all_frames", false)}});
      values.emplace_back();
    }
    for (const auto& [name, value] : cell.items()) {
      if (value.is_number() && name != "seed" && name != "frames" && name != "run")
        values[at->second][name].push_back(value.get<double>());
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [name, list] : values[r]) {
      double mean = 0.0, square = 0.0;
      for (const double v : list) mean += v / static_cast<double>(list.size());
      for (const double v : list) square += (v - mean) * (v - mean) / static_cast<double>(list.size());
      rows[r][name] = {{"mean", mean}, {"std", std::sqrt(square)}};
      rows[r]["seeds"] = list.size();
    }
  }
  return rows;
}

std::string format_table(const nlohmann::json& rows) {
  std::string table =
      "| preset | masks | filter | seeds | ATE m | RPE m | angle deg | loops | precision % | recall % | lost "
      "| occluded | ms a frame |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const nlohmann::json& row : rows) {
    const auto mean = [&](const char* key) { return figure(row, key); };
    const auto spread = [&](const char* key) { return figure(row, key, "std"); };
    table += fmt::format(
        "| {} | {} | {} | {} | {:.3f} ± {:.3f} | {:.4f} ± {:.4f} | {:.2f} ± {:.2f} | {:.1f} | {:.0f} | "
        "{:.0f} | {:.1f} | {:.1f} | {:.0f} |\n",
        row["preset"].get<std::string>(), masks_of(row), row["filter"].get<std::string>(),
        row["seeds"].get<int>(), mean("ate_m"), spread("ate_m"), mean("rpe_m"), spread("rpe_m"),
        mean("angle_deg"), spread("angle_deg"), mean("loops"), 100.0 * mean("loop_precision"),
        100.0 * mean("loop_recall"), mean("lost"), mean("occluded"), mean("median_ms"));
  }
  return table;
}

std::string format_office_table(const nlohmann::json& rows) {
  std::string table;
  for (const nlohmann::json& row : rows) {
    if (!row["office"].get<bool>()) continue;
    const auto figures = [&](const std::string& name) {
      return fmt::format("{:.4f} ± {:.4f} | {:.4f} | {:.4f} | {:.4f}", figure(row, name + "_m"),
                         figure(row, name + "_m", "std"), figure(row, name + "_mean_m"),
                         figure(row, name + "_median_m"), figure(row, name + "_sd_m"));
    };
    table += fmt::format("| {} | {}{} | {} | {} | {} | {:.0f} |\n", row["preset"].get<std::string>(),
                         masks_of(row), row["all_frames"].get<bool>() ? ", all frames" : "",
                         row["seeds"].get<int>(), figures("ate"), figures("rpe"), figure(row, "median_ms"));
  }
  if (table.empty()) return table;
  return "| preset | masks | runs | ATE rmse | mean | median | SD | RPE rmse | mean | median | SD | ms a "
         "frame |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|\n" +
         table;
}

std::string format_dynamics_table(const nlohmann::json& rows) {
  const auto known = [](double value, int digits) {
    return std::isnan(value) ? std::string() : fmt::format("{:.{}f}", value, digits);
  };
  std::map<std::string, double> plain;  // ATE by preset
  for (const nlohmann::json& row : rows) {
    if (row["masks"] == "none") plain[row["preset"].get<std::string>()] = figure(row, "ate_m");
  }
  std::string table;
  for (const nlohmann::json& row : rows) {
    if (!row["office"].get<bool>()) continue;
    const std::string preset = row["preset"].get<std::string>();
    const auto at = plain.find(preset);
    const double change =
        at == plain.end() ? std::nan("") : 100.0 * (figure(row, "ate_m") / at->second - 1.0);
    table += fmt::format("| {} | {} | {:.4f} | {} | {:.4f} | {} | {} | {} | {:.1f} |\n", preset,
                         masks_of(row), figure(row, "ate_m"), known(change, 1), figure(row, "rpe_m"),
                         known(100.0 * figure(row, "moving_recall"), 1),
                         known(100.0 * figure(row, "standing_kept"), 1),
                         known(figure(row, "static_points_ms"), 2), figure(row, "median_ms"));
  }
  if (table.empty()) return table;
  return "| preset | masks | ATE m | against none % | RPE m | moving left out % | standing kept % | "
         "constraint "
         "ms | ms a frame |\n|---|---|---|---|---|---|---|---|---|\n" +
         table;
}

}  // namespace penumbra::apps
