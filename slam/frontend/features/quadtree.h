// Spreads corners evenly over an image: of many candidates about `wanted` are kept, the strongest of each
// region.
//
// The region is split into four as long as fewer than `wanted` regions hold corners, always the region with
// the most corners first; then the strongest corner of each region is kept. O(n log n) for n candidates.
// Source: the distribution idea of ORB-SLAM (Mur-Artal et al., T-RO 2015, section IV-A), own formulation.
#pragma once

#include <vector>

#include "nn/image/fast_corners.h"

namespace penumbra::slam {

// Keeps its memory from one image to the next.
class CornerSpreader {
 public:
  // `corners`: inside `region`. Returns at most max(wanted, number of starting squares) of them, in an order
  // that depends on the input only, valid until the next call. Equal scores: the first one of the input is
  // kept.
  const std::vector<Corner>& spread(const std::vector<Corner>& corners, const Rect& region, int wanted);

 private:
  struct Node {
    float x, y, width, height;  // of its region
    int begin, end;             // its corners in the array, which is kept sorted by node
    int depth;

    int size() const { return end - begin; }
  };
  static bool is_smaller(const Node& a, const Node& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.begin > b.begin;
  }

  void begin(const std::vector<Corner>& corners, const Rect& region);
  void add(const Node& node);
  void split(const Node& node);

  std::vector<Corner> corners_, part_, kept_;
  std::vector<int> square_;  // corner of each starting square
  std::vector<Node> open_;   // a heap, the node with the most corners on top
  std::vector<Node> leaves_;
};

// With memory of its own.
inline std::vector<Corner> spread_corners(const std::vector<Corner>& corners, const Rect& region,
                                          int wanted) {
  return CornerSpreader().spread(corners, region, wanted);
}

}  // namespace penumbra::slam
