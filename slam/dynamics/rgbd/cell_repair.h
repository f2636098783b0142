// Repairs a depth map by cells (depth_repair.h): the box is cut into squares of a quarter of the window's
// shorter side (5 x 5 pixels of a box of 200 x 400). A cell with depth is one sample: the mean of its larger
// part, weighted with its pixels; the holes of a cell share one window, around the cell, and one value; a
// cell without any depth becomes a sample of weight 1. Sweeps to and fro repeat until none fills anything, at
// most four times, the last two with 3 theta2 for what looks like nothing around it.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/rgbd/depth_repair_settings.h"

namespace penumbra::slam {

// Keeps its memory from box to box; for one thread at a time.
class CellRepair {
 public:
  // Of the modes `median` and `modes`.
  explicit CellRepair(const DepthRepairSettings& settings) : settings_(settings) {}

  // `box`: inside the image; `reach`: of its window (repair_reach). Returns how many holes were filled.
  int apply(const ByteView& grey, const Rect& box, const Size& reach, FloatImage& depth);

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
  Cell make_cell(const ByteView& grey, const Rect& pixels, const Rect& box, const FloatImage& depth) const;
  void repair(Cell& hole, int column, int row, int guard, int farthest, const Size& reach, const Size& grid);
  float value_of_samples(float nearest, float farthest, std::int32_t weight);

  const DepthRepairSettings settings_;
  std::vector<Cell> cells_;
  std::vector<Sample> samples_;
};

}  // namespace penumbra::slam
