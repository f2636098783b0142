// Repairs a depth map inside the box of a detected object: pixels without depth (holes) get one from pixels
// nearby that look alike.
//
// Around a hole p with grey value g(p) lies a window of max(4, w / 10) x max(4, h / 10) pixels, w x h being
// the box's size (rounded up to an odd number). Of its pixels those count whose depth is known and whose grey
// value is near:
//
//   Q(p) = { q in the window:  z(q) > theta1 = 0,  |g(q) - g(p)| < theta2 = 5 }
//   z(p) <- mean of z over Q(p)
//
// and where Q(p) is empty the hole stays (Fang et al., their section on depth repair). The modes:
//
//   off      nothing is repaired.
//   paper    just that. Repaired values are not used for other holes.
//   border   the paper's rule for what lies beyond the sensor's range, for every hole: repaired values are
//            used for the next ones. One sweep goes right and down, a second one left and up.
//   median   by cells, and the median of Q(p) in place of the mean.
//   modes    by cells; where the depths of Q(p) span more than `two_surfaces`, they are split at the
//            geometric middle of the nearest and the farthest, and the mean is that of the larger part: the
//            mean of two surfaces lies on neither. The nearer part counts half: most holes beside an edge are
//            in the shadow of the near thing, so they are of what is behind.
//
// "By cells" is told in cell_repair.h.
//
// Depths are metres, 0 (or what is no number) where unknown. Only holes inside the box change; the window
// looks beyond it. Cost for three boxes of 200 x 400 pixels of which a quarter are holes: docs/benchmarks.md.
// paper and border keep, for each column, sums by grey value over the window's height, which move down with
// the rows, and for a run of holes the sums of 16 grey values, which move right: about 40 additions a hole,
// whatever the window.
// Source: Fang, Zhang, Wang, Pixel-Level Segmentation Algorithm Combining Depth Map Clustering and Object
// Detection (Pattern Recognition and Artificial Intelligence). The two forms by cells are ours.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/rgbd/cell_repair.h"
#include "slam/dynamics/rgbd/depth_repair_settings.h"

namespace penumbra::slam {

// Half the window's sides, pixels: it holds the pixels at most so far from its centre.
Size repair_reach(const Size& box);

// Keeps its memory from box to box; for one thread at a time.
class DepthRepair {
 public:
  explicit DepthRepair(const DepthRepairSettings& settings = {}) : settings_(settings), by_cells_(settings) {}

  // `grey`: 8 bits, of the size of `depth`. `box` may reach beyond the image: what is outside does not exist,
  // though it counts for the window's size. Returns how many holes were filled.
  int apply(const ByteView& grey, const Rect& box, FloatImage& depth);

 private:
  int sweep(const ByteView& grey, const Rect& box, const Size& reach, bool backward, FloatImage& depth);

  const DepthRepairSettings settings_;
  std::vector<std::uint64_t> columns_;  // [column][grey]: how many above bit 40, sum of depths below
  std::vector<std::pair<float*, float>> fills_;
  CellRepair by_cells_;
};

}  // namespace penumbra::slam
