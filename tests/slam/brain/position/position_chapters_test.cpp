// The examples by hand of docs/brain: head-direction.md, grid-cells.md, place-cells.md.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "slam/brain/position/head_direction_ring.h"
#include "slam/brain/position/lahn.h"
#include "slam/brain/position/oscillators.h"
#include "slam/brain/position/place_cells.h"

namespace penumbra::slam::brain {
namespace {

Eigen::Matrix2Xd directions_at(const std::vector<double>& degrees) {
  Eigen::Matrix2Xd directions(2, static_cast<Eigen::Index>(degrees.size()));
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const double angle = degrees[static_cast<std::size_t>(i)] * std::numbers::pi / 180.0;
    directions.col(i) = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return directions;
}

TEST(BrainChapters, HeadDirection) {
  HeadDirectionRing ring(directions_at({0.0, 50.0, 120.0, 180.0, 240.0, 300.0}));
  ring.turn(std::numbers::pi / 6.0, 2.0);
  EXPECT_NEAR(ring.heading() * 180.0 / std::numbers::pi, 60.0, 1e-9);
  EXPECT_NEAR(ring.response(0), 0.5, 1e-9);
  EXPECT_NEAR(ring.response(1), 0.985, 5e-4);
  EXPECT_NEAR(ring.response(2), 0.5, 1e-9);
  EXPECT_NEAR(ring.unevenness() * 180.0 / std::numbers::pi, 10.0, 1e-9);
  ring.learn(0.5, 0.1, 0.0);
  EXPECT_NEAR(std::atan2(ring.weights()(1, 1), ring.weights()(0, 1)) * 180.0 / std::numbers::pi, 55.0, 1e-9);
  EXPECT_NEAR(ring.unevenness() * 180.0 / std::numbers::pi, 5.0, 1e-9);
}

// One cell, three waves of 0.5 m at 0, 60 and 120 degrees with weight 0.577 each.
TEST(BrainChapters, GridCells) {
  Oscillators oscillators(directions_at({0.0, 60.0, 120.0}), Eigen::VectorXd::Zero(3), 0.5);
  std::vector<float> chi(6);
  const auto cosines_at = [&](double x, double y) {
    oscillators.place({x, y});
    oscillators.output(chi);
    return std::vector<float>(chi.begin(), chi.begin() + 3);
  };
  const auto output = [](const std::vector<float>& of) {
    return grid_cell_output(0.577F * (of[0] + of[1] + of[2]), LahnSettings{});
  };
  EXPECT_EQ(output(cosines_at(0.0, 0.0)), 1.0F);
  const std::vector<float> beside = cosines_at(0.25, 0.0);
  EXPECT_NEAR(beside[0], -1.0, 1e-6);
  EXPECT_NEAR(beside[1], 0.0, 1e-6);
  EXPECT_NEAR(beside[2], 0.0, 1e-6);
  EXPECT_EQ(output(beside), 0.0F);
  const double spacing = 2.0 / std::sqrt(3.0) * 0.5;
  EXPECT_NEAR(spacing, 0.577, 5e-4);
  const std::vector<float> next = cosines_at(0.5, spacing * 0.5);  // at 30 degrees
  for (const float cosine : next) EXPECT_NEAR(cosine, 1.0, 1e-5);
  EXPECT_EQ(output(next), 1.0F);

  // One step of the rule with a rate of 0.1, and the paper's.
  LahnSettings settings;
  settings.forward_rate = 0.1F;
  Eigen::MatrixXf weights(1, 2);
  weights << 0.5F, 0.1F;
  Lahn cell(weights, settings);
  const std::vector<float> input = {1.0F, 0.5F};
  cell.step(input);
  EXPECT_NEAR(cell.activity()[0], 0.35, 1e-6);
  cell.learn(input);
  EXPECT_NEAR(cell.forward()(0, 0), 0.5289, 5e-5);
  EXPECT_NEAR(cell.forward()(0, 1), 0.1163, 5e-5);

  LahnSettings paper = LahnSettings::of_rule("paper");
  weights << 1.0F, -1.0F;
  Lahn letter(weights, paper);
  const std::vector<float> strong = {2.0F, -0.5F};
  letter.step(strong);
  EXPECT_NEAR(letter.activity()[0], 0.987, 5e-4);
  letter.learn(strong);
  EXPECT_NEAR(letter.forward()(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(letter.forward()(0, 1), -0.299, 5e-4);
}

TEST(BrainChapters, PlaceCells) {
  PlaceCells cells(2);
  cells.add(std::vector<float>{1.0F, 0.0F}, {0.0, 0.0});
  cells.add(std::vector<float>{0.0F, 1.0F}, {3.0, 0.0});
  const std::vector<float> grid = {0.75F, 0.0F};
  EXPECT_NEAR(cells.activity(0, grid), 0.779, 5e-4);
  EXPECT_NEAR(cells.activity(1, grid), 0.002, 5e-4);
  EXPECT_EQ(cells.winner(grid).cell, 0U);
  EXPECT_EQ(cells.visit(grid, {0.1, 0.0}).cell, 0U);
  const std::vector<float> between = {0.5F, 0.5F};
  EXPECT_NEAR(cells.activity(0, between), 0.135, 5e-4);
  EXPECT_EQ(cells.visit(between, {1.5, 0.0}).cell, 2U);
}

}  // namespace
}  // namespace penumbra::slam::brain
