#include "slam/brain/landmarks/interest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace penumbra::slam::brain {
namespace {

Landmark region(int landmark_class, float x0, float y0, float x1, float y1, float score = 0.9F,
                int axis = 0) {
  Landmark made;
  made.x0 = x0;
  made.y0 = y0;
  made.x1 = x1;
  made.y1 = y1;
  made.landmark_class = landmark_class;
  made.score = score;
  made.descriptor[static_cast<std::size_t>(axis)] = 1.0F;
  return made;
}

// `count` lamps 40 pixels apart.
Landmarks lamps(int count) {
  Landmarks made;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(40 * i);
    made.push_back(region(kLamp, x, 50.0F, x + 10.0F, 90.0F));
  }
  return made;
}

float interest_of(const Landmarks& landmarks, int landmark_class) {
  const auto found = std::find_if(landmarks.begin(), landmarks.end(), [&](const Landmark& landmark) {
    return landmark.landmark_class == landmark_class;
  });
  return found == landmarks.end() ? -1.0F : found->interest;
}

// The example of docs/brain/interest.md.
TEST(Interest, IsTheExampleOfTheDocs) {
  Landmarks found = lamps(4);
  found.push_back(region(kSign, 300.0F, 40.0F, 312.0F, 52.0F));
  rate(found);
  EXPECT_NEAR(interest_of(found, kSign), 0.9, 1e-6);
  EXPECT_NEAR(interest_of(found, kLamp), 0.45, 1e-6) << "0.9 / sqrt(4)";
  EXPECT_EQ(found.front().landmark_class, kSign) << "the most interesting one comes first";
  Landmarks inverse = lamps(4);
  rate(inverse, {.rarity = 1.0});
  EXPECT_NEAR(interest_of(inverse, kLamp), 0.225, 1e-6) << "0.9 / 4";
}

TEST(Interest, FallsWithTheNumberOfItsClassAndWithNoOther) {
  float last = 2.0F;
  for (int count = 1; count <= 12; ++count) {
    Landmarks found = lamps(count);
    found.push_back(region(kSign, 300.0F, 40.0F, 312.0F, 52.0F));
    rate(found);
    EXPECT_LT(interest_of(found, kLamp), last) << count;
    EXPECT_NEAR(interest_of(found, kLamp), 0.9 / std::sqrt(count), 1e-6);
    EXPECT_NEAR(interest_of(found, kSign), 0.9, 1e-6) << "whatever the lamps are";
    last = interest_of(found, kLamp);
  }
  Landmarks equal = lamps(7);
  rate(equal, {.rarity = 0.0});
  EXPECT_NEAR(interest_of(equal, kLamp), 0.9, 1e-6);
}

TEST(Interest, CountsWhatIsDroppedTooAndKeepsTheMostInteresting) {
  Landmarks found = lamps(kMostLandmarks + 10);
  found.push_back(region(kPoster, 0.0F, 0.0F, 20.0F, 20.0F, 0.5F));
  rate(found);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(kMostLandmarks));
  EXPECT_EQ(found.front().landmark_class, kPoster);
  EXPECT_NEAR(interest_of(found, kLamp), 0.9 / std::sqrt(kMostLandmarks + 10.0), 1e-6);
}

TEST(Interest, DoesNotDependOnTheOrderOfTheRegions) {
  Landmarks one = lamps(5);
  one.push_back(region(kSign, 300.0F, 40.0F, 312.0F, 52.0F, 0.4F));
  Landmarks other(one.rbegin(), one.rend());
  rate(one);
  rate(other);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].x0, other[i].x0);
    EXPECT_EQ(one[i].interest, other[i].interest);
  }
}

// The paper's sign with the traffic light under it.
TEST(Interest, TouchingRegionsJoinIntoOneLandmark) {
  Landmarks found{region(kSign, 100.0F, 40.0F, 116.0F, 56.0F, 0.8F, 3),
                  region(kLamp, 104.0F, 56.0F, 112.0F, 100.0F, 0.6F, 4)};
  rate(found, {.join = true});
  ASSERT_EQ(found.size(), 1U);
  const Landmark& joint = found.front();
  EXPECT_EQ(joint.landmark_class, kSign);
  EXPECT_EQ(joint.x0, 100.0F);
  EXPECT_EQ(joint.y0, 40.0F);
  EXPECT_EQ(joint.x1, 116.0F);
  EXPECT_EQ(joint.y1, 100.0F);
  EXPECT_FLOAT_EQ(joint.interest, 0.8F);
  // (0.8, 0.6) is of length 1 already.
  EXPECT_NEAR(joint.descriptor[3], 0.8F, 1e-6F);
  EXPECT_NEAR(joint.descriptor[4], 0.6F, 1e-6F);
}

TEST(Interest, RegionsApartOfOneClassOrLargeDoNotJoin) {
  const Landmark sign = region(kSign, 100.0F, 40.0F, 116.0F, 56.0F);
  for (const Landmark& other :
       {region(kLamp, 104.0F, 60.0F, 112.0F, 100.0F), region(kSign, 104.0F, 56.0F, 112.0F, 80.0F),
        region(kFacade, 90.0F, 0.0F, 250.0F, 120.0F)}) {
    Landmarks found{sign, other};
    rate(found, {.join = true});
    EXPECT_EQ(found.size(), 2U) << other.landmark_class;
  }
  Landmarks touching{sign, region(kLamp, 104.0F, 56.0F, 112.0F, 100.0F)};
  rate(touching, {.join = false});
  EXPECT_EQ(touching.size(), 2U) << "only where it is asked for";
}

}  // namespace
}  // namespace penumbra::slam::brain
