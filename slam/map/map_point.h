// A point of the world that several keyframes have seen.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/patch.h"

namespace penumbra::slam {

struct KeyFrame;

// Feature `feature` of `keyframe` shows the point.
struct Observation {
  KeyFrame* keyframe = nullptr;
  int feature = 0;
};

// Owned and changed by Map; everybody else reads.
struct MapPoint {
  int id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, metres
  Descriptor descriptor{};                             // the most typical one of its observations
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // mean unit direction from the cameras to the point
  double reference_distance = 0.0;                     // metres at which it would be found on level 0
  std::vector<Observation> observations;               // ordered by the keyframes' ids
  bool descriptor_is_current = false;                  // no observation came or went since it was chosen
  int first_keyframe = 0;                              // id of the keyframe that made it
  int visible = 1, found = 1;                          // frames that should have seen it, and that did
  std::array<std::uint8_t, 3> colour{};                // blue, green, red

  // How the point looked from the newest keyframe that its patch was aligned in, and its depth there
  // (metres).
  Patch patch;
  double patch_depth = 0.0;

  bool erased = false;              // no longer part of the map
  MapPoint* replacement = nullptr;  // for an erased point: the point that it was merged into

  double found_ratio() const { return static_cast<double>(found) / static_cast<double>(visible); }
};

// What a point is now: itself, what it was merged into, or nullptr where it was erased.
inline MapPoint* present(MapPoint* point) {
  while (point != nullptr && point->erased) point = point->replacement;
  return point;
}

}  // namespace penumbra::slam
