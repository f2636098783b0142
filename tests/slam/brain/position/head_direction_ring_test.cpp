#include "slam/brain/position/head_direction_ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

constexpr double kRingDegree = std::numbers::pi / 180.0;

TEST(HeadDirectionRing, KeepsTheHeading) {
  HeadDirectionRing ring(RingSettings{}, 1);
  ring.set_heading(0.3);
  for (int i = 0; i < 1000; ++i) ring.turn(0.5, 0.01);
  EXPECT_NEAR(ring.heading(), std::remainder(0.3 + 5.0, 2.0 * std::numbers::pi), 1e-9);
  for (int i = 0; i < 1000; ++i) ring.turn(-0.5, 0.01);
  EXPECT_NEAR(ring.heading(), 0.3, 1e-9);
}

TEST(HeadDirectionRing, RespondsWithTheCosineToEachDirection) {
  HeadDirectionRing ring(RingSettings{}, 2);
  ring.set_heading(1.1);
  for (int i = 0; i < ring.directions(); ++i) {
    const double preferred = std::atan2(ring.weights()(1, i), ring.weights()(0, i));
    EXPECT_NEAR(ring.response(i), std::cos(1.1 - preferred), 1e-12);
  }
}

TEST(HeadDirectionRing, TrainingMakesItEvenToADegree) {
  for (std::uint64_t seed = 900; seed < 905; ++seed) {
    EXPECT_GT(HeadDirectionRing(RingSettings{}, seed).unevenness(), 10.0 * kRingDegree);
    const HeadDirectionRing ring = HeadDirectionRing::trained({}, seed);
    EXPECT_LT(ring.unevenness(), 1.0 * kRingDegree) << seed;
    for (const auto cell : ring.weights().colwise()) EXPECT_NEAR(cell.norm(), 1.0, 1e-12);
    EXPECT_EQ(ring.weights(), HeadDirectionRing::trained({}, seed).weights());
  }
}

// Why the tension is there.
TEST(HeadDirectionRing, WithoutTensionItStaysUneven) {
  RingSettings settings;
  settings.last_tension = 0.0;
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    worst = std::max(worst, HeadDirectionRing::trained(settings, seed).unevenness());
  }
  EXPECT_GT(worst, 1.0 * kRingDegree);
}

TEST(HeadDirectionRing, UnevennessIsTheWorstGap) {
  Eigen::Matrix2Xd weights(2, 6);
  for (int i = 0; i < 6; ++i) {
    const double angle = (60.0 * i + (i == 2 ? 7.0 : 0.0)) * kRingDegree;
    weights.col(i) = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  EXPECT_NEAR(HeadDirectionRing(weights).unevenness(), 7.0 * kRingDegree, 1e-9);
}

TEST(HeadDirectionRing, RefusesNumbersThatMakeNoHexagons) {
  RingSettings settings;
  for (const int n : {8, 0, -6}) {
    settings.directions = n;
    EXPECT_THROW(HeadDirectionRing(settings, 1), InputError) << n;
  }
}

}  // namespace
}  // namespace penumbra::slam::brain
