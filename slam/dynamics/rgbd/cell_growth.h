// Gives each cell of a box to the object or to the rest (step 2 of object_in_box.h).
//
// The object's depth belongs to other things as well, to the desk beside a person. How far a cell is from
// outside, that is from the ring and from depths in the box that cannot be the object's, is the length of the
// shortest path from cell to cell, of which a step from depth z to z' and colour c to c' (the channel that
// differs most) costs
//
//   1 + min(100, ((z - z') / (0.02 m + 0.005 z^2 / m))^2) + min(12, ((c - c') / 8)^2)
//
// The cells of the object's clusters that are hardest to reach are certain; every other goes to whom it is
// nearer, to them or to outside. Cells up to 3 % beside the box are not outside: a detector's boxes cut
// things off.
// Source: the shortest paths are those of Bai and Sapiro, A geodesic framework for fast interactive image and
// video segmentation (ICCV 2007).
#pragma once

#include <array>
#include <vector>

#include "slam/dynamics/rgbd/box_cells.h"

namespace penumbra::slam {

// Keeps its memory from box to box; for one thread at a time.
class CellGrowth {
 public:
  struct Seed {
    int first = 0, last = 0;               // clusters of the object
    double nearest = 0.0, farthest = 0.0;  // metres, that may still be the object
  };

  // Sets is_object of all cells; their clusters are given.
  void grow(BoxCells& cells, const Seed& seed);

 private:
  void reach(BoxCells& cells, int at, int distance, bool is_object);
  void spread(BoxCells& cells);

  std::vector<int> distance_, far_;
  std::array<std::vector<int>, 256> buckets_;  // cells by distance modulo 256
  int left_ = 0;                               // in the buckets
};

}  // namespace penumbra::slam
