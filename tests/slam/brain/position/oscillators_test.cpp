#include "slam/brain/position/oscillators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace penumbra::slam::brain {
namespace {

HeadDirectionRing even_ring(int n) {
  Eigen::Matrix2Xd weights(2, n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n;
    weights.col(i) = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return HeadDirectionRing(weights);
}

TEST(Oscillators, PhasesDependOnThePlaceAlone) {
  HeadDirectionRing ring = even_ring(12);
  const Eigen::VectorXd start = Oscillators::random_start(12, 3);
  Oscillators gone(ring.weights(), start, 0.5), placed = gone;
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  for (int i = 0; i < 200; ++i) {
    ring.set_heading(0.1 * i * std::sin(i));
    gone.advance(ring, 0.3, 0.05);
    x += 0.015 * Eigen::Vector2d(std::cos(ring.heading()), std::sin(ring.heading()));
  }
  placed.place(x);
  EXPECT_LT((gone.position() - x).norm(), 1e-12);
  std::vector<float> a(24), b(24);
  gone.output(a);
  placed.output(b);
  for (std::size_t j = 0; j < a.size(); ++j) EXPECT_NEAR(a[j], b[j], 1e-5);
}

TEST(Oscillators, GiveCosineAndSineOfThePhases) {
  const HeadDirectionRing ring = even_ring(6);
  Eigen::VectorXd start = Eigen::VectorXd::Constant(6, 0.2);
  Oscillators oscillators(ring.weights(), start, 2.0);
  oscillators.place({0.25, 0.0});
  std::vector<float> chi(static_cast<std::size_t>(oscillators.outputs()));
  oscillators.output(chi);
  const double phase = 0.2 + std::numbers::pi * 0.25;  // along x
  EXPECT_NEAR(chi[0], std::cos(phase), 1e-6);
  EXPECT_NEAR(chi[6], std::sin(phase), 1e-6);
  EXPECT_NEAR(chi[3], std::cos(0.2 - std::numbers::pi * 0.25), 1e-6);
}

TEST(Oscillators, BoundaryFactorTakesExcitationAlone) {
  EXPECT_NEAR(boundary_factor(0.1), 1.0 - std::exp(-1.0), 1e-12);
  EXPECT_EQ(boundary_factor(0.0), 0.0);
  EXPECT_GT(boundary_factor(1.0), 0.9999);
  std::vector<float> chi = {1.0F, -1.0F, 0.5F, 0.0F};
  apply_boundary_factor(0.5, chi);
  EXPECT_EQ(chi, (std::vector<float>{0.5F, -1.0F, 0.25F, 0.0F}));
}

}  // namespace
}  // namespace penumbra::slam::brain
