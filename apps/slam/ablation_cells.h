// The cells of an ablation, with their networks, and their results, which are kept in files: what is there
// already is not run again.
//
//   OUT/drives/NAME        recordings, made once
//   OUT/cells/NAME.json    a cell's figures, whole; a file that is anything else is written anew. For the
//   office beside it NAME.svg, its path, and NAME.png, what
//                          became of the features of the frame with the most on people
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/slam/ablation.h"

namespace penumbra::apps {

struct NamedWeights {
  std::string name, file;
  std::string content;  // the file's size and CRC-32: results of other weights under this name do not count
};

// Of NAME=FILE or FILE, whose name it then has. UsageError for two of the same name, and for a name that
// would not do in the names of files; InputError for a file that cannot be read.
std::vector<NamedWeights> named_weights(const std::vector<std::string>& texts);

// Adds the cell, `runs` times or, where that is 0, once and deterministic, with every network where it takes
// masks or boxes of one. UsageError where it needs one and there is none.
void add_cells(AblationCell cell, int runs, const std::vector<NamedWeights>& weights,
               std::vector<AblationCell>& cells);

// Runs the cells whose results are not in their files yet, and says how far it is, as `title`; returns the
// rows of the table (summarise_cells).
nlohmann::json run_cells(const std::string& title, const std::vector<AblationCell>& cells,
                         const std::filesystem::path& out, const std::vector<NamedWeights>& weights);

// Adds --runs, which add_cells takes.
void add_runs_option(CLI::App* command, int& runs);

}  // namespace penumbra::apps
