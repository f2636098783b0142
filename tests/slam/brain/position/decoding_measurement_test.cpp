#include "slam/brain/position/decoding_measurement.h"

#include <gtest/gtest.h>

#include <vector>

#include "slam/brain/position/grid_training.h"

namespace penumbra::slam::brain {
namespace {

constexpr double kNextScale = 1.4142135623730951;

DecodingSettings few_trials() {
  DecodingSettings settings;
  settings.trials = 60;
  return settings;
}

GridTrainingSettings three_modules() {
  GridTrainingSettings settings;
  settings.modules = 3;
  settings.seed = 900;
  return settings;
}

// Learning makes the weights long enough for a cell to stand out of noise, and that is all that it is worth
// to decoding: random weights of the same length do as well.
TEST(Decoding, LearningIsWorthTheLengthOfTheWeights) {
  const GridCode trained = train_grid_code(three_modules()).at_scales(0.5, kNextScale);
  const GridCode raw = train_grid_code(three_modules(), true).at_scales(0.5, kNextScale);
  const double deviation = activity_deviation(trained);
  const std::vector<double> noises = {0.0, 0.1 * deviation, 0.3 * deviation};
  const std::vector<DecodingError> of_trained = measure_decoding(trained, noises, few_trials());
  EXPECT_LT(of_trained[0].percentile_95, 0.01);
  EXPECT_LT(of_trained[1].percentile_95, 0.01);
  EXPECT_LT(of_trained[2].percentile_95, 0.03);
  EXPECT_GT(measure_decoding(raw, std::vector<double>{noises[2]}, few_trials())[0].percentile_95, 0.1);
  const GridCode stretched = as_long_as(raw, trained);
  EXPECT_LT(measure_decoding(stretched, std::vector<double>{noises[2]}, few_trials())[0].percentile_95, 0.03);
}

TEST(Decoding, OneScaleAloneIsAmbiguous) {
  GridCode one = train_grid_code(three_modules());
  one.modules.resize(1);
  EXPECT_GT(measure_decoding(one, std::vector<double>{0.05}, few_trials())[0].median, 0.1);
}

TEST(Decoding, DeviationIsThatOfTheActivities) {
  GridCode code = train_grid_code(three_modules());
  EXPECT_GT(activity_deviation(code), 0.3);
  EXPECT_LT(activity_deviation(code), 0.5);
  for (GridModule& module : code.modules) module.weights.setZero();
  EXPECT_EQ(activity_deviation(code), 0.0);
}

TEST(Decoding, StretchedWeightsAreAsLong) {
  const GridCode trained = train_grid_code(three_modules()), raw = train_grid_code(three_modules(), true);
  const GridCode stretched = as_long_as(raw, trained);
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_NEAR(stretched.modules[m].weights.norm(), trained.modules[m].weights.norm(), 1e-3);
    EXPECT_NEAR(stretched.modules[m].weights(3, 4) / raw.modules[m].weights(3, 4),
                stretched.modules[m].weights(0, 1) / raw.modules[m].weights(0, 1), 1e-3);
  }
}

}  // namespace
}  // namespace penumbra::slam::brain
