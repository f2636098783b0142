#include "slam/evaluation/plan_evaluation.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

// Rows from top to bottom: '.' free, '#' blocked, ' ' unknown.
OccupancyGrid grid_of(double cell, const Eigen::Vector2d& origin, const std::vector<std::string>& rows) {
  OccupancyGrid grid;
  grid.cell = cell;
  grid.origin = origin;
  grid.cells.create(static_cast<int>(rows.front().size()), static_cast<int>(rows.size()));
  for (int y = 0; y < grid.cells.height(); ++y) {
    for (int x = 0; x < grid.cells.width(); ++x) {
      const char c = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      grid.cells.at(x, y) = c == '.'   ? OccupancyGrid::kFree
                            : c == '#' ? OccupancyGrid::kBlocked
                                       : OccupancyGrid::kUnknown;
    }
  }
  return grid;
}

TEST(PlanEvaluation, OfTheTruthItselfIsPerfect) {
  const OccupancyGrid truth = grid_of(0.5, {-1.0, 2.0}, {"...##", "....#", "..   "});
  const PlanScore score = score_plan(truth, truth);
  EXPECT_EQ(score.free_right, 1.0);
  EXPECT_EQ(score.free_near, 1.0);
  EXPECT_EQ(score.blocked_right, 1.0);
  EXPECT_EQ(score.obstacles, 1.0);
  EXPECT_NEAR(score.free_square_metres, 9 * 0.25, 1e-12);
  EXPECT_NEAR(score.blocked_square_metres, 3 * 0.25, 1e-12);
}

TEST(PlanEvaluation, CountsWhatIsWrong) {
  const OccupancyGrid truth = grid_of(1.0, {0.0, 0.0}, {"....####", "....####", "....####"});
  // Two free cells inside the obstacle, one at its rim; an obstacle that is not there; the rim is not shown.
  const OccupancyGrid plan = grid_of(1.0, {0.0, 0.0}, {"#....   ", "....  ..", "....    "});
  const PlanScore score = score_plan(plan, truth);
  EXPECT_DOUBLE_EQ(score.free_right, 11.0 / 14.0);
  EXPECT_DOUBLE_EQ(score.free_near, 12.0 / 14.0);
  EXPECT_EQ(score.blocked_right, 0.0);
  EXPECT_EQ(score.obstacles, 0.0);
  // Shown one cell too far inside: the rim is still within a cell.
  const PlanScore late = score_plan(grid_of(1.0, {0.0, 0.0}, {".... #  ", ".... #  ", ".... #  "}), truth);
  EXPECT_EQ(late.obstacles, 1.0);
  EXPECT_EQ(late.blocked_right, 1.0);
}

TEST(PlanEvaluation, BringsCellsOfOtherSizesTogether) {
  const OccupancyGrid fine = grid_of(0.5, {-0.5, -0.5}, {"......", "...#..", "......", "......"});
  const OccupancyGrid coarse = grid_of(1.0, {-0.5, -0.5}, {".#.", "..."});
  // Of a coarse plan, a cell is blocked where a part of it is.
  const PlanScore score = score_plan(coarse, fine);
  EXPECT_EQ(score.free_right, 1.0);
  EXPECT_EQ(score.blocked_right, 1.0);
  // Of a fine plan, the cells of the coarse truth that they lie in count.
  EXPECT_DOUBLE_EQ(score_plan(fine, coarse).free_right, 20.0 / 23.0);
  // Elsewhere nothing is known, and nothing counts.
  EXPECT_EQ(score_plan(grid_of(1.0, {50.0, 50.0}, {"..", "##"}), fine).free_right, 1.0);
}

}  // namespace
}  // namespace penumbra::slam
