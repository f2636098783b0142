// A landmark: a salient region of an image, by which a place is known again.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace penumbra::slam::brain {

// What the interest network tells apart; the numbers are those of its class channels.
enum LandmarkClass : int {
  kNothing = 0,  // ground, sky, plain walls
  kPerson = 1,
  kVehicle = 2,
  kSign = 3,  // from here on classes of what stands: the only ones that become landmarks
  kLamp = 4,
  kPlant = 5,
  kFacade = 6,
  kScreen = 7,
  kPoster = 8,
  kFurniture = 9,
  kSmallThing = 10,
};
constexpr int kLandmarkClasses = 11;
constexpr int kFirstStandingClass = kSign;
constexpr int kStandingClasses = kLandmarkClasses - kFirstStandingClass;
// "nothing", "person", ...
const char* name_of(LandmarkClass landmark_class);
// Whether regions of the class may become landmarks: persons and vehicles move, or will.
constexpr bool stands(int landmark_class) {
  return landmark_class >= kFirstStandingClass && landmark_class < kLandmarkClasses;
}

constexpr int kDescriptorSize = 32;
using Descriptor = std::array<float, kDescriptorSize>;

struct Landmark {
  float x0 = 0.0F, y0 = 0.0F, x1 = 0.0F, y1 = 0.0F;  // its box, pixels
  int landmark_class = kNothing;
  float score = 0.0F;       // mean probability of its class, 0..1
  float interest = 0.0F;    // 0..1, see interest.h
  Descriptor descriptor{};  // unit length
};

// Of one image, the most interesting first; at most kMostLandmarks.
using Landmarks = std::vector<Landmark>;
constexpr int kMostLandmarks = 24;

}  // namespace penumbra::slam::brain
