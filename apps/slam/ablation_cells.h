// The cells of an ablation, with their networks, and their results, which are kept in files: what is there
// already is not run again.
//
//   OUT/drives/NAME        recordings, made once
//   OUT/cells/NAME.json    a cell's figures; for the office beside it NAME.svg, its path, and NAME.png, what
//                          became of the features of the frame with the most on people
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/slam/ablation.h"

namespace penumbra::apps {

struct NamedWeights {
  std::string name, file;
};

// Of NAME=FILE or FILE, whose name it then has. UsageError for two of the same name.
std::vector<NamedWeights> named_weights(const std::vector<std::string>& texts);

// Adds the cell, with every network where it takes masks or boxes of one. UsageError where it needs one and
// there is none.
void add_cells(AblationCell cell, const std::vector<NamedWeights>& weights, std::vector<AblationCell>& cells);

// Makes the folders below `out`; throws Error where they cannot be made.
void prepare_cells(const std::filesystem::path& out);

// The cell's result, from its file where it has one.
nlohmann::json result_of(const AblationCell& cell, const std::filesystem::path& out,
                         const std::vector<NamedWeights>& weights);

}  // namespace penumbra::apps
