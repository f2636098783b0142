#include "slam/brain/position/grid_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "slam/brain/position/grid_training.h"
#include "tests/support/allocation_counter.h"

namespace penumbra::slam::brain {
namespace {

GridCode short_code(int modules) {
  GridTrainingSettings settings;
  settings.modules = modules;
  settings.seconds = 20.0;
  settings.rule.cells = 5;
  return train_grid_code(settings);
}

TEST(GridCode, IsTheNetworksOutputAtThePlace) {
  const GridCode code = short_code(2);
  GridCodeReader reader(code);
  const Eigen::Vector2d place(0.31, -0.72);
  const std::span<const float> activity = reader.at(place);
  ASSERT_EQ(activity.size(), 10U);
  for (std::size_t m = 0; m < 2; ++m) {
    const GridModule& module = code.modules[m];
    for (Eigen::Index i = 0; i < 5; ++i) {
      double drive = 0.0;
      for (Eigen::Index j = 0; j < 12; ++j) {
        const double phase =
            module.start[j] + 2.0 * std::numbers::pi / module.wavelength * code.directions.col(j).dot(place);
        drive += module.weights(i, j) * std::cos(phase) + module.weights(i, 12 + j) * std::sin(phase);
      }
      EXPECT_NEAR(activity[m * 5 + static_cast<std::size_t>(i)], std::clamp(drive - 0.2, 0.0, 1.0), 1e-5);
    }
  }
}

TEST(GridCode, StretchesWithItsWavelength) {
  const GridCode code = short_code(1);
  GridCodeReader small(code), large(code.at_scales(4.0, 1.4));
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d place(0.07 * i, -0.03 * i);
    const std::span<const float> a = small.at(place), b = large.at(8.0 * place);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-5);
  }
  const GridCode three = short_code(3).at_scales(2.0, 1.5);
  EXPECT_DOUBLE_EQ(three.modules[2].wavelength, 4.5);
  EXPECT_EQ(three.cells(), 15);
}

TEST(GridCode, IsReadWithoutAllocating) {
  GridCodeReader reader(short_code(3));
  const std::size_t before = test::allocation_count();
  for (int i = 0; i < 100; ++i) reader.at(Eigen::Vector2d(0.1 * i, 0.0));
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace penumbra::slam::brain
