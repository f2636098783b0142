#include "slam/brain/motion/odometry_noise.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

Trajectory straight(int frames, double metres_a_frame = 1.0) {
  Trajectory path;
  for (int i = 0; i < frames; ++i) path.push_back({0.1 * i, camera_pose({metres_a_frame * i, 0.0, 0.0})});
  return path;
}

PlanePose end_of(const std::vector<SelfMotion>& motions) {
  PlanePose pose;
  for (const SelfMotion& motion : motions) pose = pose * step_of(motion);
  return pose;
}

TEST(OdometryNoise, NoneIsTheTruth) {
  const PlanePose end = end_of(spoiled_odometry(straight(101), odometry_noise("none"), 1));
  EXPECT_NEAR(end.x, 100.0, 1e-9);
  EXPECT_NEAR(end.y, 0.0, 1e-9);
}

TEST(OdometryNoise, ScaleAndBiasAreWhatTheySay) {
  OdometryNoise noise;
  noise.scale = 0.05;
  EXPECT_NEAR(end_of(spoiled_odometry(straight(101), noise, 1)).x, 105.0, 1e-9);
  noise = {};
  noise.gyro_bias = 0.01;
  EXPECT_NEAR(end_of(spoiled_odometry(straight(101), noise, 1)).heading, 0.1, 1e-9);
}

TEST(OdometryNoise, WhiteNoiseDoesNotDependOnTheFrameRate) {
  OdometryNoise noise;
  noise.white_speed = 0.1;
  for (const int step : {1, 4}) {
    double squares = 0.0;
    constexpr int kRuns = 400;
    for (int seed = 0; seed < kRuns; ++seed) {
      Trajectory path;
      for (int i = 0; i <= 100; i += step) path.push_back({0.1 * i, camera_pose({1.0 * i, 0.0, 0.0})});
      const double error = end_of(spoiled_odometry(path, noise, static_cast<std::uint64_t>(seed))).x - 100.0;
      squares += error * error;
    }
    // 0.1 m per square root of a metre, over 100 m.
    EXPECT_NEAR(std::sqrt(squares / kRuns), 1.0, 0.15) << step;
  }
}

TEST(OdometryNoise, SlipsComeAboutAsOftenAsTheyShould) {
  OdometryNoise noise;
  noise.slips = 6.0;
  const std::vector<SelfMotion> motions = spoiled_odometry(straight(6001), noise, 3);  // ten minutes
  int slips = 0;
  for (std::size_t i = 2; i < motions.size(); ++i)
    slips += motions[i].speed > 14.0 && !(motions[i - 1].speed > 14.0);
  EXPECT_NEAR(slips, 57, 20);
}

TEST(OdometryNoise, RepeatsByItsSeed) {
  const OdometryNoise noise = odometry_noise("rough");
  const PlanePose a = end_of(spoiled_odometry(straight(50), noise, 1)),
                  b = end_of(spoiled_odometry(straight(50), noise, 1)),
                  c = end_of(spoiled_odometry(straight(50), noise, 2));
  EXPECT_EQ(a.x, b.x);
  EXPECT_NE(a.x, c.x);
}

TEST(OdometryNoise, RefusesTimesThatGoBackAndUnknownNames) {
  Trajectory path = straight(3);
  path[2].timestamp = 0.05;
  EXPECT_THROW(spoiled_odometry(path, {}, 1), InputError);
  EXPECT_THROW(spoiled_odometry(straight(1), {}, 1), InputError);
  EXPECT_THROW(odometry_noise("loud"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam::brain
