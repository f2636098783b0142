#include "slam/dynamics/rgbd/cell_growth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace penumbra::slam {

namespace {

using Place = BoxCell::Place;

constexpr double kHigh = 0.8;        // quantile of the distances from outside ...
constexpr double kCertain = 0.25;    // ... and the share of it from which on a cell is certain
constexpr int kMostDistance = 1000;  // that counts for it: what cannot be reached is not farther
constexpr double kGap = 0.03;        // share of the box's sides by which the box may be too small
constexpr float kColourStep = 8.0F, kMostColour = 12.0F;

// Grey values, of the channel that differs most.
float difference(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b) {
  int most = 0;
  for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
  return static_cast<float>(most);
}

int step_cost(const BoxCell& from, const BoxCell& to) {
  const float g = difference(from.colour, to.colour) / kColourStep;
  const float colour = std::min(kMostColour, g * g);
  if (from.depth == 0.0F || to.depth == 0.0F) return 4 + static_cast<int>(colour);
  const float jump = (from.depth - to.depth) / (0.02F + 0.005F * from.depth * from.depth);
  return 1 + static_cast<int>(std::min(100.0F, jump * jump) + colour);
}

}  // namespace

// Puts the cell at that distance from its side, unless it is nearer to one already.
void CellGrowth::reach(BoxCells& cells, int at, int distance, bool is_object) {
  if (distance >= distance_[static_cast<std::size_t>(at)]) return;
  distance_[static_cast<std::size_t>(at)] = distance;
  cells.cells[static_cast<std::size_t>(at)].is_object = is_object;
  buckets_[static_cast<std::size_t>(distance) % buckets_.size()].push_back(at);
  ++left_;
}

// From the cells in the buckets on, the nearest first, to all others.
void CellGrowth::spread(BoxCells& cells) {
  const int width = cells.grid.width;
  for (int distance = 0; left_ > 0; ++distance) {
    std::vector<int>& bucket = buckets_[static_cast<std::size_t>(distance) % buckets_.size()];
    for (std::size_t n = 0; n < bucket.size(); ++n) {
      const int at = bucket[n];
      --left_;
      if (distance_[static_cast<std::size_t>(at)] != distance) continue;
      const BoxCell& cell = cells.cells[static_cast<std::size_t>(at)];
      const int column = at % width, row = at / width;
      const auto step_to = [&](int to) {
        const BoxCell& next = cells.cells[static_cast<std::size_t>(to)];
        if (next.place == Place::outside) return;
        reach(cells, to, distance + step_cost(cell, next), cell.is_object);
      };
      if (column > 0) step_to(at - 1);
      if (column + 1 < width) step_to(at + 1);
      if (row > 0) step_to(at - width);
      if (row + 1 < cells.grid.height) step_to(at + width);
    }
    bucket.clear();
  }
}

void CellGrowth::grow(BoxCells& cells, const Seed& seed) {
  const Rect& grid = cells.grid;
  const auto in_run = [&](const BoxCell& cell) {
    return cell.cluster >= seed.first && cell.cluster <= seed.last;
  };
  const auto gap = [&](int ring, int length) {
    return ring - static_cast<int>(std::lround(kGap * (length - 2 * ring)));
  };
  const int gap_x = gap(cells.ring.width, grid.width), gap_y = gap(cells.ring.height, grid.height);
  const auto near_box = [&](int at) {
    const int column = at % grid.width, row = at / grid.width;
    return column >= gap_x && column < grid.width - gap_x && row >= gap_y && row < grid.height - gap_y;
  };
  constexpr int kFar = 1 << 29;
  distance_.assign(cells.cells.size(), kFar);
  for (std::vector<int>& bucket : buckets_) bucket.clear();
  left_ = 0;
  for (int at = 0; at < grid.area(); ++at) {
    const BoxCell& cell = cells.cells[static_cast<std::size_t>(at)];
    if (cell.place == Place::outside) continue;
    const auto z = static_cast<double>(cell.depth);
    if ((cell.place == Place::ring && !near_box(at)) || (z > 0.0 && (z > seed.farthest || z < seed.nearest)))
      reach(cells, at, 0, false);
  }
  spread(cells);
  // What is hardest to reach from outside is certain.
  far_.clear();
  for (int at = 0; at < grid.area(); ++at) {
    const BoxCell& cell = cells.cells[static_cast<std::size_t>(at)];
    if (cell.place == Place::box && in_run(cell))
      far_.push_back(std::min(distance_[static_cast<std::size_t>(at)], kMostDistance));
  }
  if (far_.empty()) return;
  const auto high = far_.begin() + static_cast<std::ptrdiff_t>(kHigh * static_cast<double>(far_.size() - 1));
  std::nth_element(far_.begin(), high, far_.end());
  const int certain = std::max(1, static_cast<int>(kCertain * *high));
  for (int at = 0; at < grid.area(); ++at) {
    const BoxCell& cell = cells.cells[static_cast<std::size_t>(at)];
    if (cell.place == Place::box && in_run(cell) && distance_[static_cast<std::size_t>(at)] >= certain)
      reach(cells, at, 0, true);
  }
  spread(cells);
}

}  // namespace penumbra::slam
