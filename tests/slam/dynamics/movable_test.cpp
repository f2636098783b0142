#include "slam/dynamics/movable.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

TEST(MovableClasses, AreKnownByNameWhateverTheCase) {
  for (const char* name :
       {"person", "Car", "BUS", "motorcycle", "dog", "rider", "train", "cyclist", "truck"}) {
    EXPECT_TRUE(is_movable_class(name)) << name;
  }
  for (const char* name : {"traffic light", "bench", "stop sign", "sign", "", "potted plant"}) {
    EXPECT_FALSE(is_movable_class(name)) << name;
  }
}

TEST(MovingPrior, OrdersPeopleVehiclesAndThings) {
  EXPECT_GT(moving_prior("person"), moving_prior("Car"));
  EXPECT_GT(moving_prior("car"), 0.0);
  EXPECT_LT(moving_prior("traffic light"), 0.0);
}

}  // namespace
}  // namespace penumbra::slam
