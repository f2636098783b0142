// The nearest of several descriptors, and how near the second is: what every search for a feature ends with.
// Of equals the first offered wins.
#pragma once

#include "slam/frontend/features/feature.h"

namespace penumbra::slam {

struct NearestDescriptor {
  int index = -1;  // -1: none was near enough
  int distance = kDescriptorBits + 1;
  int second_index = -1;
  int second_distance = kDescriptorBits + 1;

  // Only candidates nearer than `limit` (Hamming) can be the nearest.
  static NearestDescriptor within(int limit) { return {-1, limit, -1, kDescriptorBits + 1}; }

  void offer(int candidate, int d) {
    if (d < distance) {
      second_distance = distance;
      second_index = index;
      distance = d;
      index = candidate;
    } else if (d < second_distance) {
      second_distance = d;
      second_index = candidate;
    }
  }
  // Whether the second is nearly as near: the nearest may be so by chance (Lowe, IJCV 2004).
  bool is_ambiguous(float ratio) const {
    return static_cast<float>(distance) > ratio * static_cast<float>(second_distance);
  }
};

}  // namespace penumbra::slam
