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

TEST(MotionModel, ANewBeginningPresumesTheMeanUntilAMotionIsMeasured) {
  MotionModel motion;
  motion.observe(at(1.0), at(0.0), 0.0, 0.1);
  motion.observe(at(3.0), at(1.0), 0.1, 0.2);
  EXPECT_TRUE(motion.measured());
  motion.presume_mean();
  EXPECT_TRUE(motion.known());
  EXPECT_FALSE(motion.measured());
  EXPECT_NEAR(motion.predict(at(3.0), 0.2, 0.3).translation.z(), 4.4, 1e-9);
  motion.observe(at(4.0), at(3.0), 0.2, 0.3);
  EXPECT_TRUE(motion.measured());
  EXPECT_NEAR(motion.predict(at(4.0), 0.3, 0.4).translation.z(), 5.0, 1e-9);
}

TEST(MotionModel, WithoutAMotionThereIsNoneToPresume) {
  MotionModel motion;
  motion.presume_mean();
  EXPECT_FALSE(motion.known());
  EXPECT_FALSE(motion.measured());
}

}  // namespace
}  // namespace penumbra::slam
