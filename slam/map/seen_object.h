// An object that a keyframe shows, as the semantics tell it to the map.
#pragma once

#include <Eigen/Core>
#include <string>

#include "nn/image/image.h"

namespace penumbra::slam {

struct SeenObject {
  int number = 0;                                      // of the object within the map
  std::string class_name;                              // empty: found by its motion alone
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // keyframe's camera frame, metres
  Rect region;                                         // around its mask, pixels of the left image
  bool stands = false;  // its class cannot move, or its motion was measured and it stood

  bool operator==(const SeenObject&) const = default;
};

}  // namespace penumbra::slam
