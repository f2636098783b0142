#include "slam/brain/motion/calibration.h"

#include <gtest/gtest.h>

#include <limits>

namespace penumbra::slam::brain {
namespace {

TEST(OdometryCalibration, ByHandOneStep) {
  // At the start 10 m seen of 10 m felt; a step of 1 m that was seen to be 1.1 m.
  OdometryCalibration calibration(100.0, 30.0);
  ASSERT_TRUE(calibration.learn({1.0, 0.0, 0.0}, {1.1, 0.0, 0.05}, 1.0));
  const double keep = std::exp(-1.0 / 100.0);
  EXPECT_NEAR(calibration.gain(), (10.0 * keep + 1.1) / (10.0 * keep + 1.0), 1e-12);
  // 3 s without a turn, then 0.05 rad too few in a second.
  EXPECT_NEAR(calibration.bias(), 0.05 / (3.0 * std::exp(-1.0 / 30.0) + 1.0), 1e-12);
}

TEST(OdometryCalibration, FindsScaleAndBias) {
  OdometryCalibration calibration(100.0, 30.0);
  for (int i = 0; i < 400; ++i) {
    const SelfMotion felt{9.5, 0.1 * std::sin(0.1 * i) - 0.02, 0.2}, seen{10.0, 0.1 * std::sin(0.1 * i), 0.2};
    calibration.learn(step_of(felt), step_of(seen), 0.2);
  }
  EXPECT_NEAR(calibration.gain(), 10.0 / 9.5, 1e-3);
  EXPECT_NEAR(calibration.bias(), 0.02, 2e-3);
  const SelfMotion corrected = calibration.corrected({9.5, -0.02, 0.2});
  EXPECT_NEAR(corrected.speed, 10.0, 0.02);
  EXPECT_NEAR(corrected.turn_rate, 0.0, 2e-3);
}

TEST(OdometryCalibration, SlipsAndNonsenseTeachNothing) {
  OdometryCalibration calibration(100.0, 30.0);
  EXPECT_FALSE(calibration.learn({1.5, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.2));
  EXPECT_FALSE(calibration.learn({1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 0.2));
  EXPECT_FALSE(calibration.learn({1.0, 0.0, 0.0}, {1.0, 0.0, 0.3}, 0.2));
  EXPECT_FALSE(calibration.learn({1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.0));
  EXPECT_FALSE(calibration.learn({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.2));
  EXPECT_EQ(calibration.gain(), 1.0);
  EXPECT_EQ(calibration.bias(), 0.0);
}

TEST(OdometryCalibration, ARobotThatStandsLearnsItsBias) {
  OdometryCalibration calibration(100.0, 30.0);
  for (int i = 0; i < 600; ++i) calibration.learn({0.0, 0.0, 0.002}, {}, 0.1);
  EXPECT_EQ(calibration.gain(), 1.0);
  EXPECT_NEAR(calibration.bias(), -0.02, 1e-3);
}

}  // namespace
}  // namespace penumbra::slam::brain
