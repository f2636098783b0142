// What the cells of an ablation say together, as tables.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace penumbra::apps {

// Rows of the table: cells that differ by nothing but their seed, mean and standard deviation of each figure.
// `cells`: objects with the cell's keys and run_cell's.
nlohmann::json summarise_cells(const nlohmann::json& cells);
std::string format_table(const nlohmann::json& rows);
// As the paper's tables 1 to 3: RMSE, mean, median and standard deviation of ATE and RPE, of the office's
// rows; empty where there are none.
std::string format_office_table(const nlohmann::json& rows);
// Of the office's rows: the share of the ATE of the row `none` of the same preset, what became of features in
// people's boxes, and the time of the constraint; empty where there are none.
std::string format_dynamics_table(const nlohmann::json& rows);

}  // namespace penumbra::apps
