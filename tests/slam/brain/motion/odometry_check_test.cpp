#include "slam/brain/motion/odometry_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bytes.h"

namespace penumbra::slam::brain {
namespace {

// 40 steps of a metre with turns to both sides, felt as `way` and `turn` times what they were.
std::string doubt_of(double way, double turn, int steps = 40) {
  OdometryCheck check;
  for (int i = 0; i < steps; ++i) {
    const double heading = 0.15 * std::sin(0.4 * i);
    check.add({way, 0.0, turn * heading}, {1.0, 0.0, heading});
  }
  return check.doubt();
}

TEST(OdometryCheck, ACheapEncoderIsNotDoubted) {
  EXPECT_EQ(doubt_of(1.05, 0.97), "");
  EXPECT_EQ(doubt_of(0.9, 1.2), "");
}

TEST(OdometryCheck, UnitsAndSignsAre) {
  EXPECT_CONTAINS(doubt_of(3.6, 1.0), "3.60 m for each metre");
  EXPECT_CONTAINS(doubt_of(0.001, 1.0), "metres a second");
  EXPECT_CONTAINS(doubt_of(-1.0, 1.0), "backwards");
  EXPECT_CONTAINS(doubt_of(1.0, -1.0), "to the left");
  EXPECT_CONTAINS(doubt_of(1.0, 57.3), "57.30 times");
}

TEST(OdometryCheck, LittleSaysNothing) {
  EXPECT_EQ(doubt_of(3.6, 1.0, 5), "");
  EXPECT_EQ(OdometryCheck().doubt(), "");
}

}  // namespace
}  // namespace penumbra::slam::brain
