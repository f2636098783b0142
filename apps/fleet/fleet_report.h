// What became of a fleet's recordings: a table, and a page with their paths.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace penumbra::apps {

// `stopped`: a signal ended it and its results are those until then. `failed`: it ended otherwise, or its
// machine did. `not_begun`: also where what is there is of an earlier plan.
enum class FleetState { done, at_work, stopped, failed, not_begun };

// The figures are those of its run.json; -1 where that does not have them.
struct FleetRow {
  std::string name;
  FleetState state = FleetState::not_begun;
  int frames = -1, located = -1, keyframes = -1;
  double path_m = -1.0, ape_m = -1.0;  // ape_m: of recordings that come with the truth
  std::string last_words;              // unless done: why, as its log says
};

const char* name_of(FleetState state);

// One row a line of the plan's jobs.tsv, in its order. Throws InputError where `plan` has none.
std::vector<FleetRow> read_fleet(const std::filesystem::path& plan);

// Why there is no merged map of the plan, as its log says; empty where there is one.
std::string why_not_merged(const std::filesystem::path& plan);

// With a heading, tabs between.
std::string fleet_table(const std::vector<FleetRow>& rows);
// Links and pictures are relative to `plan`.
std::string fleet_page(const std::filesystem::path& plan, const std::vector<FleetRow>& rows);

}  // namespace penumbra::apps
