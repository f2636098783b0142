// Semi-global matching: the cost of a disparity at a pixel, with what it costs to come there along straight
// paths through the image.
//
//   L_r(p, d) = C(p, d) + min( L_r(p - r, d),  L_r(p - r, d +- 1) + P1,  min_k L_r(p - r, k) + P2 )
//                       - min_k L_r(p - r, k)
//   S(p, d)   = sum over the directions r of  L_r(p, d)
//
// L_r = C where p - r is outside. P1 is for slopes, P2 for edges. Eight directions in two passes, one from
// the upper left to the lower right (from the left, and from the three pixels above), one back; they do not
// depend on each other and may run at the same time. Each pass keeps the L of two rows. Numbers stay below
// 4 (24 + P2). Cost: 8 operations a pixel, disparity and direction, on vectors along d: of both passes 63 %
// of dense_disparity.h's.
//
// Source: Hirschmueller, Stereo processing by semiglobal matching and mutual information (PAMI 2008), eq. 13.
#pragma once

#include <cstdint>
#include <vector>

#include "slam/frontend/disparity/disparity_volume.h"

namespace penumbra::slam {

struct PathPenalties {
  int slope = 10;  // P1
  int edge = 40;   // P2, at least P1
};

class PathPass {
 public:
  enum class Way { down, up };

  // `sum` becomes the sum over the pass's four directions. The number of disparities is a multiple of 8.
  void run(const DisparityVolume<std::uint8_t>& cost, const PathPenalties& penalties, Way way,
           DisparityVolume<std::int16_t>& sum);

 private:
  std::vector<std::int16_t> paths_;  // L of two rows, the one before and the one at hand, in four directions
  std::vector<std::int16_t> least_;  // min_k of each
};

}  // namespace penumbra::slam
