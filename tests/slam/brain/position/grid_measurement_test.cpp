#include "slam/brain/position/grid_measurement.h"

#include <gtest/gtest.h>

namespace penumbra::slam::brain {
namespace {

GridMeasurement measured(const char* rule, bool untrained, RoomShape room = RoomShape::square,
                         double seconds = 1000.0) {
  GridTrainingSettings settings;
  settings.rule = LahnSettings::of_rule(rule);
  settings.rule.cells = 12;
  settings.room = room;
  settings.seconds = seconds;
  settings.seed = 900;
  return measure_grid_cells(settings, untrained);
}

TEST(GridMeasurement, GridCellsBecomeHexagonalInEveryRoom) {
  for (const RoomShape room : {RoomShape::square, RoomShape::hexagon, RoomShape::l_shape}) {
    const GridMeasurement cells = measured("rectified", false, room);
    ASSERT_TRUE(cells.finite);
    ASSERT_EQ(cells.frozen.size(), 12U);
    EXPECT_GT(summary_of(cells.frozen_gridness).median, 1.3) << to_string(room);
    EXPECT_GE(summary_of(cells.frozen_gridness).share, 0.9) << to_string(room);
    EXPECT_GT(summary_of(cells.live_gridness).median, 1.3) << to_string(room);
    EXPECT_LT(cells.alike_maps, 0.02) << to_string(room);
    EXPECT_LT(cells.alike_weights, 0.02) << to_string(room);
  }
}

TEST(GridMeasurement, TheyNeedTimeAndTraining) {
  const GridnessSummary early =
      summary_of(measured("rectified", false, RoomShape::square, 40.0).live_gridness);
  EXPECT_LT(early.share, 0.6);
  const GridMeasurement untrained = measured("rectified", true);
  EXPECT_LT(summary_of(untrained.frozen_gridness).median, 0.5);
  EXPECT_LT(summary_of(untrained.live_gridness).median, 0.5);
}

// The letter of the paper.
TEST(GridMeasurement, ThePapersRuleLearnsNothing) {
  const GridMeasurement cells = measured("paper", false);
  ASSERT_TRUE(cells.finite);
  EXPECT_EQ(summary_of(cells.frozen_gridness).share, 0.0);
  EXPECT_LT(summary_of(cells.live_gridness).median, 0.3);
  EXPECT_GT(cells.alike_weights, 0.95);  // one cell, up to its sign
  EXPECT_GT(cells.alike_maps, 0.3);
}

}  // namespace
}  // namespace penumbra::slam::brain
