// Repairs a depth map inside the box of a detected object: pixels without depth (holes) get one from pixels
// nearby that look alike.
//
// Around a hole p with grey value g(p) lies a window of max(4, w / 10) x max(4, h / 10) pixels, w x h being
// the box's size (rounded up to an odd number). Of its pixels those count whose depth is known and whose grey
// value is near:
//
//   Q(p) = { q in the window:  z(q) > theta1 = 0,  |g(q) - g(p)| < theta2 = 5 },   z(p) <- mean of z over
//   Q(p)
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
// "By cells": the box is cut into squares of a quarter of the window's shorter side (5 x 5 pixels of a box of
// 200 x 400). A cell with depth is one sample: the mean of its larger part, weighted with its pixels; the
// holes of a cell share one window, around the cell, and one value; a cell without any depth becomes a sample
// of weight 1. Sweeps to and fro repeat until none fills anything, at most four times, the last two with
// 3 theta2 for what looks like nothing around it.
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

namespace penumbra::slam {

enum class RepairMode { off, paper, border, median, modes };

struct DepthRepairSettings {
  RepairMode mode = RepairMode::modes;
  int grey_difference = 5;  // theta2, grey values; 1 to 5
  double nearer_votes = 0.5;
  double two_surfaces = 0.1;  // of the nearer depth
  int farthest = 20;          // pixels from a measured depth, by cells: a hole beyond stays one
};

// Half the window's sides, pixels: it holds the pixels at most so far from its centre.
Size repair_reach(const Size& box);

// Keeps its memory from box to box; for one thread at a time.
class DepthRepair {
 public:
  explicit DepthRepair(const DepthRepairSettings& settings = {}) : settings_(settings) {}

  // `grey`: 8 bits, of the size of `depth`. `box` may reach beyond the image: what is outside does not exist,
  // though it counts for the window's size. Returns how many holes were filled.
  int apply(const ByteView& grey, const Rect& box, FloatImage& depth);

 private:
  struct Cell {
    float depth = 0.0F;  // 0: none
    std::int32_t weight = 0;
    std::int32_t grey = 0;
    std::int32_t holes = 0;      // of the box
    std::int32_t hole_grey = 0;  // mean
    float repaired = 0.0F;       // of its holes; 0: none yet
    std::int32_t away = 0;       // cells from the nearest one that was measured and counted for its depth
  };
  struct Sample {
    float depth = 0.0F;
    std::int32_t weight = 0;
  };
  int sweep(const ByteView& grey, const Rect& box, const Size& reach, bool backward, FloatImage& depth);
  int repair_by_cells(const ByteView& grey, const Rect& box, const Size& reach, FloatImage& depth);
  Cell make_cell(const ByteView& grey, const Rect& pixels, const Rect& box, const FloatImage& depth) const;
  void repair(Cell& hole, int column, int row, int guard, int farthest, const Size& reach, const Size& grid);
  float value_of_samples(float nearest, float farthest, std::int32_t weight);

  const DepthRepairSettings settings_;
  std::vector<std::uint64_t> columns_;  // [column][grey]: how many above bit 40, sum of depths below
  std::vector<std::pair<float*, float>> fills_;
  std::vector<Cell> cells_;
  std::vector<Sample> samples_;
};

}  // namespace penumbra::slam
