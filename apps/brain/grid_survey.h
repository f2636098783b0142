// What grid cells learn by the rule that works and by the paper's, over time, beside untrained ones; and how
// well a position is read off them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "slam/brain/position/decoding_measurement.h"
#include "slam/brain/position/grid_measurement.h"

namespace penumbra::apps {

// Cells of all seeds together.
struct SurveyPoint {
  double seconds = 0.0;
  slam::brain::GridnessSummary frozen, live;
  double alike_maps = 0.0;  // share of pairs of cells of one network, mean over seeds
};

struct SurveyRow {
  std::string name;
  bool untrained = false;
  slam::brain::GridTrainingSettings settings;
  std::vector<SurveyPoint> points;
  std::vector<slam::brain::GridMeasurement> examples;  // of the first seed, a point each
};

// At 0.1, 0.6 and 1 times the seconds of `settings` (untrained: at the end), networks of `seeds` seeds from
// that of `settings` on. done(n) after n networks of survey_size(seeds).
std::vector<SurveyRow> survey_grid_cells(const slam::brain::GridTrainingSettings& settings, int seeds,
                                         const std::function<void(int)>& done);
int survey_size(int seeds);

struct DecodingRow {
  std::string name;
  std::vector<slam::brain::DecodingError> errors;  // for each noise
};

// Three modules of 0.5, 0.71 and 1 m in a room of 10 m. `noises` in standard deviations of the trained code's
// activity.
std::vector<DecodingRow> survey_decoding(const slam::brain::GridTrainingSettings& settings,
                                         const std::vector<double>& noises);

void print_survey(const std::vector<SurveyRow>& rows);
void print_decoding(const std::vector<DecodingRow>& rows, const std::vector<double>& noises);

}  // namespace penumbra::apps
