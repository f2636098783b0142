#include "slam/brain/position/gridness.h"

#include <gtest/gtest.h>

#include <vector>

#include "slam/brain/position/random_stream.h"
#include "tests/slam/brain/position/made_maps.h"

namespace penumbra::slam::brain {
namespace {

constexpr double kSpacing = 11.547;  // bins, of waves 10 bins long

GridnessScores gridness_of(const RateMap& map) {
  const Autocorrelogram correlogram = autocorrelogram(map);
  return Gridness(correlogram.radius).score(correlogram, kSpacing);
}

TEST(Gridness, TellsHexagonsFromAllElse) {
  for (const double turn : {0.0, 0.2, 0.5}) {
    const GridnessScores hexagons = gridness_of(test::waves_map(40, 3, 10.0, turn));
    EXPECT_NEAR(hexagons.fixed, 1.40, 0.06) << turn;
    EXPECT_GE(hexagons.best, hexagons.fixed - 0.1);
    EXPECT_LT(gridness_of(test::waves_map(40, 2, 10.0, turn)).fixed, -1.0) << turn;
    EXPECT_LT(gridness_of(test::waves_map(40, 1, 10.0, turn)).fixed, 0.3) << turn;
  }
}

TEST(Gridness, OfNoiseIsLow) {
  RandomStream random(3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(gridness_of(test::made_map(40, [&](double, double) { return random.uniform(); })).fixed, 0.3);
  }
}

TEST(Gridness, IsZeroWithoutChange) {
  const GridnessScores flat = gridness_of(test::made_map(40, [](double, double) { return 0.0; }));
  EXPECT_EQ(flat.fixed, 0.0);
  EXPECT_EQ(flat.best, 0.0);
}

TEST(Gridness, SummaryCountsCellsAboveALimit) {
  const std::vector<double> scores = {1.3, 0.3, 0.31, -0.5, 1.0};
  const GridnessSummary summary = summary_of(scores);
  EXPECT_DOUBLE_EQ(summary.median, 0.31);
  EXPECT_DOUBLE_EQ(summary.share, 0.6);
  EXPECT_EQ(summary_of({}).share, 0.0);
}

}  // namespace
}  // namespace penumbra::slam::brain
