// FAST-9 corners: pixels that are clearly brighter, or clearly darker, than an arc of 9 or more of the 16
// pixels p_k on a circle of radius 3 around them.
//
//   score(c) = max( max over arcs min over the arc (p_k - c),  max over arcs min over the arc (c - p_k) ) - 1
//
// is the highest threshold at which c is a corner. Of neighbouring corners the one stays whose score is above
// those of all 8 around it (3 x 3 non-maximum suppression).
//
// The scores of a region are computed once; corners of any rectangle in it and of any threshold from the
// lowest one up are then found in them. Cost at 1241 x 376 and threshold 7: 0.4 ms on one core.
// Source: Rosten and Drummond, Machine learning for high-speed corner detection (ECCV 2006), computed for
// whole rows instead of by a decision tree. The corners and their order are those of cv::FAST.
#pragma once

#include <vector>

#include "nn/image/image.h"

namespace penumbra {

struct Corner {
  int x = 0, y = 0;  // pixel of the image
  int score = 0;     // grey values

  bool operator==(const Corner&) const = default;
};

class FastCorners {
 public:
  static constexpr int kRadius = 3;

  // Scores the pixels of `region`, which lies kRadius or more inside `image` (8 bits, grey). Scores below
  // `threshold`, 0..254, count as none. Keeps its memory for the next image.
  void measure(const ByteView& image, const Rect& region, int threshold);

  // Appends the corners of a rectangle inside the region whose score is `threshold` or more, row by row.
  // Pixels outside the rectangle do not suppress any.
  void find(const Rect& where, int threshold, std::vector<Corner>& corners);

 private:
  void find_everywhere(int threshold, std::vector<Corner>& corners);
  void find_in_part(const Rect& where, int threshold, std::vector<Corner>& corners);

  Rect region_;
  ByteImage scores_;  // of the region, with a frame of one 0 around it
  std::vector<std::uint8_t> is_peak_;
};

}  // namespace penumbra
