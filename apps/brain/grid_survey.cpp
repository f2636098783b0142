#include "apps/brain/grid_survey.h"

#include <fmt/core.h>

#include <numbers>

namespace penumbra::apps {

namespace {

using slam::brain::DecodingError;
using slam::brain::GridCode;
using slam::brain::GridMeasurement;
using slam::brain::GridTrainingSettings;
using slam::brain::LahnSettings;
using slam::brain::LateralRule;

constexpr double kTimes[] = {0.1, 0.6, 1.0};

// The rows of the survey, still without figures.
std::vector<SurveyRow> survey_rows(const GridTrainingSettings& settings) {
  std::vector<SurveyRow> rows;
  const auto add = [&](const char* name, const LahnSettings& rule, bool boundary_factor, bool untrained) {
    SurveyRow row{name, untrained, settings, {}, {}};
    row.settings.rule = rule;
    row.settings.boundary_factor = boundary_factor;
    rows.push_back(std::move(row));
  };
  const LahnSettings rectified = LahnSettings::of_rule("rectified"), paper = LahnSettings::of_rule("paper");
  LahnSettings alone = rectified;
  alone.lateral = LateralRule::none;
  add("rectified", rectified, false, false);
  add("  with R_p", rectified, true, false);
  add("  no lateral", alone, false, false);
  add("untrained", rectified, false, true);
  add("paper", paper, false, false);
  add("  with R_p", paper, true, false);
  return rows;
}

SurveyPoint measure_point(SurveyRow& row, double seconds, int seeds, const std::function<void()>& done) {
  SurveyPoint point{.seconds = seconds, .frozen = {}, .live = {}, .alike_maps = 0.0};
  std::vector<double> frozen, live;
  GridTrainingSettings settings = row.settings;
  settings.seconds = seconds;
  for (int i = 0; i < seeds; ++i, ++settings.seed) {
    GridMeasurement measured = measure_grid_cells(settings, row.untrained);
    frozen.insert(frozen.end(), measured.frozen_gridness.begin(), measured.frozen_gridness.end());
    live.insert(live.end(), measured.live_gridness.begin(), measured.live_gridness.end());
    point.alike_maps += measured.alike_maps / seeds;
    if (i == 0) row.examples.push_back(std::move(measured));
    done();
  }
  point.frozen = slam::brain::summary_of(frozen);
  point.live = slam::brain::summary_of(live);
  return point;
}

}  // namespace

int survey_size(int seeds) {
  int points = 0;
  for (const SurveyRow& row : survey_rows({}))
    points += row.untrained ? 1 : static_cast<int>(std::size(kTimes));
  return points * seeds;
}

std::vector<SurveyRow> survey_grid_cells(const GridTrainingSettings& settings, int seeds,
                                         const std::function<void(int)>& done) {
  std::vector<SurveyRow> rows = survey_rows(settings);
  int networks = 0;
  for (SurveyRow& row : rows) {
    for (const double time : kTimes) {
      if (row.untrained && time != 1.0) continue;
      row.points.push_back(measure_point(row, time * settings.seconds, seeds, [&] { done(++networks); }));
    }
  }
  return rows;
}

std::vector<DecodingRow> survey_decoding(const GridTrainingSettings& settings,
                                         const std::vector<double>& noises) {
  GridTrainingSettings three = settings;
  three.modules = 3;
  const auto scaled = [&](const GridCode& code) {
    return code.at_scales(settings.wavelength, std::numbers::sqrt2);
  };
  const GridCode trained = scaled(train_grid_code(three)), untrained = scaled(train_grid_code(three, true));
  const double deviation = slam::brain::activity_deviation(trained);
  std::vector<double> sizes;
  for (const double noise : noises) sizes.push_back(noise * deviation);
  std::vector<DecodingRow> rows;
  const auto add = [&](const char* name, const GridCode& code) {
    rows.push_back({name, slam::brain::measure_decoding(code, sizes)});
  };
  add("trained", trained);
  if (three.rule.lateral == LateralRule::foeldiak) {
    three.rule.lateral = LateralRule::none;
    add("  no lateral", scaled(train_grid_code(three)));
  }
  add("untrained", untrained);
  add("  stretched", slam::brain::as_long_as(untrained, trained));
  GridCode one = trained;
  one.modules.resize(1);
  add("one module", one);
  return rows;
}

void print_survey(const std::vector<SurveyRow>& rows) {
  fmt::print("Gridness on the fixed ring: median, and share of cells above 0.3\n");
  fmt::print("{:<14}{:>9}   {:>14}   {:>14}   {:>12}\n", "rule", "seconds", "frozen maps", "live maps",
             "cells alike");
  for (const SurveyRow& row : rows) {
    for (const SurveyPoint& point : row.points) {
      fmt::print("{:<14}{:>9.0f}   {:>6.2f} {:>5.1f} %   {:>6.2f} {:>5.1f} %   {:>10.1f} %\n", row.name,
                 point.seconds, point.frozen.median, 100.0 * point.frozen.share, point.live.median,
                 100.0 * point.live.share, 100.0 * point.alike_maps);
    }
  }
}

void print_decoding(const std::vector<DecodingRow>& rows, const std::vector<double>& noises) {
  fmt::print("Error of a position read off three modules, % of a room of 10 m: median, 95th percentile\n");
  fmt::print("{:<14}", "weights");
  for (const double noise : noises) fmt::print("{:>17}", fmt::format("{:.0f} % noise", 100.0 * noise));
  fmt::print("\n");
  for (const DecodingRow& row : rows) {
    fmt::print("{:<14}", row.name);
    for (const DecodingError& error : row.errors) {
      fmt::print("{:>17}", fmt::format("{:.2f}  {:.2f}", 100.0 * error.median, 100.0 * error.percentile_95));
    }
    fmt::print("\n");
  }
}

}  // namespace penumbra::apps
