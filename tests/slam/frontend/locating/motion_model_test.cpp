#include "slam/frontend/locating/motion_model.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

SE3 at(double z) {
  SE3 T;
  T.translation.z() = z;
  return T;
}

TEST(MotionModel, PredictsTheLastMotionAndCoastsOnTheMean) {
  MotionModel motion;
  EXPECT_FALSE(motion.known());
  EXPECT_EQ(motion.predict(at(3.0), 0.0, 0.1).translation.z(), 3.0);
  for (int i = 1; i <= 10; ++i) motion.observe(at(1.0 * i), at(1.0 * i - 1.0), 0.1 * i - 0.1, 0.1 * i);
  motion.observe(at(12.0), at(10.0), 1.0, 1.1);
  EXPECT_NEAR(motion.predict(at(12.0), 1.1, 1.2).translation.z(), 14.0, 1e-9);
  EXPECT_NEAR(motion.coast(at(12.0), 1.1, 1.2).translation.z(), 13.4, 1e-9);
  EXPECT_NEAR(motion.predict(at(12.0), 1.1, 1.15).translation.z(), 13.0, 1e-9);  // half the time
}

}  // namespace
}  // namespace penumbra::slam
