// A feature: a corner of the image pyramid with an orientation and a 256-bit descriptor.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace penumbra::slam {

struct Keypoint {
  float u = 0.0F, v = 0.0F;  // pixels of the full image (level 0)
  int level = 0;             // pyramid level it was found on, 0 is the full image
  float angle = 0.0F;        // orientation in radians, -pi..pi, from +u towards +v
  float response = 0.0F;     // corner strength (FAST score)
};

using Descriptor = std::array<std::uint64_t, 4>;

inline constexpr int kDescriptorBits = 256;

// Number of bits that differ, 0..256.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

// The features of one image; entry i of every vector belongs to feature i.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;

  int size() const { return static_cast<int>(keypoints.size()); }
  void clear() {
    keypoints.clear();
    descriptors.clear();
  }
};

}  // namespace penumbra::slam
