#include "slam/frontend/features/nearest_descriptor.h"

#include <gtest/gtest.h>

#include "slam/frontend/features/level_of_size.h"

namespace penumbra::slam {
namespace {

TEST(NearestDescriptor, KeepsTheTwoNearest) {
  NearestDescriptor nearest;
  EXPECT_EQ(nearest.index, -1);
  for (const auto& [candidate, distance] : {std::pair(4, 90), {7, 30}, {2, 60}, {9, 30}}) {
    nearest.offer(candidate, distance);
  }
  EXPECT_EQ(nearest.index, 7) << "the first of equals";
  EXPECT_EQ(nearest.distance, 30);
  EXPECT_EQ(nearest.second_index, 9);
  EXPECT_EQ(nearest.second_distance, 30);
  EXPECT_TRUE(nearest.is_ambiguous(0.9F));
}

TEST(NearestDescriptor, IsAmbiguousWhereTheSecondIsNearlyAsNear) {
  NearestDescriptor nearest;
  nearest.offer(0, 40);
  EXPECT_FALSE(nearest.is_ambiguous(0.8F)) << "alone";
  nearest.offer(1, 51);
  EXPECT_FALSE(nearest.is_ambiguous(0.8F));
  nearest.offer(2, 49);
  EXPECT_TRUE(nearest.is_ambiguous(0.8F));
}

TEST(NearestDescriptor, HasALimit) {
  NearestDescriptor nearest = NearestDescriptor::within(51);
  nearest.offer(3, 51);
  EXPECT_EQ(nearest.index, -1);
  nearest.offer(5, 50);
  EXPECT_EQ(nearest.index, 5);
}

TEST(LevelOfSize, CountsFactors) {
  const std::vector<double> scales = {1.0, 1.2, 1.44};
  EXPECT_NEAR(level_of_size(1.44, level_step(scales)), 2.0, 1e-12);
  EXPECT_NEAR(level_of_size(1.0 / 1.2, level_step(scales)), -1.0, 1e-12);
  EXPECT_EQ(level_step({1.0}), 1.0);
}

}  // namespace
}  // namespace penumbra::slam
