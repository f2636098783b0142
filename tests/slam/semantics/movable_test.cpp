#include "slam/semantics/movable.h"

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

TEST(MovableFeatures, AreThoseOnAMaskAndCloseToIt) {
  Instance car{3, "car", 0.9F, cv::Rect(100, 50, 40, 20), cv::Mat1b(20, 40, uchar{255})};
  car.mask(cv::Rect(0, 0, 20, 20)) = 0;  // only the right half: columns 120..139
  const std::vector<Keypoint> keypoints = {{130.0F, 60.0F}, {105.0F, 60.0F}, {118.0F, 60.0F},
                                           {142.0F, 60.0F}, {300.0F, 10.0F}, {0.0F, 0.0F}};
  std::vector<char> movable(keypoints.size(), 0);
  mark_movable_features({car}, keypoints, 0.5, 3, movable);
  EXPECT_EQ(movable, (std::vector<char>{1, 0, 1, 1, 0, 0}));
}

TEST(MovableFeatures, IgnoreWeakInstancesAndThingsThatStand) {
  const cv::Mat1b mask(20, 40, uchar{255});
  const std::vector<Instance> instances = {{3, "car", 0.3F, cv::Rect(0, 0, 40, 20), mask},
                                           {10, "traffic light", 0.9F, cv::Rect(0, 0, 40, 20), mask}};
  std::vector<char> movable = {0, 1};
  mark_movable_features(instances, {{10.0F, 10.0F}, {300.0F, 10.0F}}, 0.5, 3, movable);
  EXPECT_EQ(movable, (std::vector<char>{0, 1}));
}

}  // namespace
}  // namespace penumbra::slam
