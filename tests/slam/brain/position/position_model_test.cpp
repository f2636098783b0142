#include "slam/brain/position/position_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/allocation_counter.h"

namespace penumbra::slam::brain {
namespace {

TEST(PositionModel, ACircleCloses) {
  PositionModel model(standard_grid_code());
  const std::vector<float> start(model.activity().begin(), model.activity().end());
  const double turn_rate = 2.0 * std::numbers::pi / 360.0;
  for (int i = 0; i < 180; ++i) model.move(10.0, turn_rate, 1.0);
  EXPECT_NEAR(model.position().x(), 0.0, 1e-6);
  EXPECT_NEAR(model.position().y(), 20.0 / turn_rate, 0.1);
  EXPECT_NEAR(std::abs(model.heading()), std::numbers::pi, 1e-9);
  for (int i = 0; i < 180; ++i) model.move(10.0, turn_rate, 1.0);
  EXPECT_LT(model.position().norm(), 1e-6);
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(model.activity()[i], start[i], 1e-4);
}

TEST(PositionModel, ResetIsAsHavingGoneThere) {
  PositionModel gone(standard_grid_code()), placed(standard_grid_code());
  for (int i = 0; i < 100; ++i) gone.move(12.0, 0.02 * std::sin(0.1 * i), 0.1);
  placed.reset(gone.position(), gone.heading());
  EXPECT_LT((placed.position() - gone.position()).norm(), 1e-9);
  EXPECT_NEAR(placed.heading(), gone.heading(), 1e-12);
  for (std::size_t i = 0; i < gone.activity().size(); ++i) {
    EXPECT_NEAR(placed.activity()[i], gone.activity()[i], 1e-4);
  }
  const std::span<const float> elsewhere = placed.activity_at(gone.position());
  for (std::size_t i = 0; i < elsewhere.size(); ++i) EXPECT_NEAR(elsewhere[i], gone.activity()[i], 1e-4);
}

TEST(PositionModel, MovesWithoutAllocating) {
  PositionModel model(standard_grid_code());
  model.move(1.0, 0.1, 0.1);
  const std::size_t before = test::allocation_count();
  for (int i = 0; i < 100; ++i) model.move(1.0, 0.1, 0.1);
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace penumbra::slam::brain
