#include "slam/brain/position/place_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "nn/base/error.h"
#include "slam/brain/position/position_model.h"
#include "slam/brain/position/random_stream.h"
#include "tests/support/allocation_counter.h"

namespace penumbra::slam::brain {
namespace {

TEST(PlaceCells, TheNearestActivityWins) {
  RandomStream random(3);
  PlaceCells cells(7);
  std::vector<std::vector<float>> kept;
  for (int i = 0; i < 50; ++i) {
    std::vector<float> grid(7);
    for (float& x : grid) x = static_cast<float>(random.uniform());
    EXPECT_EQ(cells.add(grid, {i, 0.0}), static_cast<std::size_t>(i));
    kept.push_back(grid);
  }
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<float> grid(7);
    for (float& x : grid) x = static_cast<float>(random.uniform());
    std::size_t nearest = 0;
    double least = 1e9;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      double squared = 0.0;
      for (std::size_t k = 0; k < 7; ++k) squared += std::pow(grid[k] - kept[i][k], 2);
      const double p = std::exp(-squared / (2.0 * 0.25 * 0.25 * 7.0));
      EXPECT_NEAR(cells.activity(i, grid), p, 1e-5);
      if (squared < least) least = squared, nearest = i;
    }
    const PlaceCells::Winner winner = cells.winner(grid);
    EXPECT_EQ(winner.cell, nearest);
    EXPECT_EQ(winner.place.x(), static_cast<double>(nearest));
    EXPECT_DOUBLE_EQ(winner.activity, cells.activity(nearest, grid));
  }
}

TEST(PlaceCells, ANewPlaceGetsACellAndAnOldOneKeepsIts) {
  PositionModel model(standard_grid_code());
  PlaceCells cells(static_cast<int>(model.activity().size()));
  for (int i = 0; i <= 200; ++i) {
    model.reset({0.5 * i, 0.0}, 0.0);
    cells.visit(model.activity(), model.position());
  }
  const std::size_t made = cells.size();
  EXPECT_GT(made, 20U);
  EXPECT_LT(made, 201U);
  for (int i = 0; i <= 200; ++i) {
    model.reset({0.5 * i, 0.0}, 0.0);
    const PlaceCells::Winner winner = cells.visit(model.activity(), model.position());
    EXPECT_GE(winner.activity, 0.5);
    EXPECT_LT((winner.place - model.position()).norm(), 5.0) << i;
  }
  EXPECT_EQ(cells.size(), made);
}

TEST(PlaceCells, OnASquareReadTheirOwnPlaces) {
  const GridCode code = standard_grid_code().at_scales(0.5, 1.4142135623730951);
  const PlaceCells cells = PlaceCells::on_square(code, {3.0, -1.0}, 1.0, 0.25);
  ASSERT_EQ(cells.size(), 81U);
  EXPECT_EQ(cells.place(0), Eigen::Vector2d(2.0, -2.0));
  EXPECT_EQ(cells.place(80), Eigen::Vector2d(4.0, 0.0));
  GridCodeReader reader(code);
  for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(cells.winner(reader.at(cells.place(i))).cell, i);
}

TEST(PlaceCells, FindTheWinnerWithoutAllocating) {
  PlaceCells cells(8);
  const std::vector<float> grid(8, 0.5F);
  for (int i = 0; i < 10; ++i) cells.add(grid, {i, 0.0});
  const std::size_t before = test::allocation_count();
  EXPECT_EQ(cells.winner(grid).cell, 0U);  // of equal ones the first
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PlaceCells, WithoutACellThereIsNoWinner) {
  EXPECT_THROW(PlaceCells(8).winner(std::vector<float>(8)), InputError);
}

}  // namespace
}  // namespace penumbra::slam::brain
