#include "slam/brain/landmarks/landmark.h"

namespace penumbra::slam::brain {

const char* name_of(LandmarkClass landmark_class) {
  static constexpr const char* kNames[kLandmarkClasses] = {"nothing", "person",    "vehicle",    "sign",
                                                           "lamp",    "plant",     "facade",     "screen",
                                                           "poster",  "furniture", "small thing"};
  return kNames[landmark_class];
}

}  // namespace penumbra::slam::brain
