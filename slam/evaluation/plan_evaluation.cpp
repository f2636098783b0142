#include "slam/evaluation/plan_evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace penumbra::slam {

namespace {

constexpr std::uint8_t kFree = OccupancyGrid::kFree, kBlocked = OccupancyGrid::kBlocked;

// What the truth says of the plan's cells.
ByteImage at_cells_of(const OccupancyGrid& plan, const OccupancyGrid& truth) {
  ByteImage cells = ByteImage::filled(plan.cells.width(), plan.cells.height(), OccupancyGrid::kUnknown);
  // First and end of the truth's cells, `size` of them along one axis, whose middles lie in the plan's cell
  // that begins at `metres`; where the truth's cells are the larger ones, the one that its middle lies in.
  const auto parts_in = [&](double metres, double origin, int size) {
    const auto place = [&](double cell) {  // those far outside all at -1 or `size`, which an int holds
      return static_cast<int>(std::clamp(cell, -1.0, static_cast<double>(size)));
    };
    int first = place(std::ceil((metres - origin) / truth.cell - 0.5));
    int end = place(std::ceil((metres + plan.cell - origin) / truth.cell - 0.5));
    if (first == end) {
      first = place(std::floor((metres + 0.5 * plan.cell - origin) / truth.cell));
      end = first + 1;
    }
    return std::pair(std::max(0, first), std::min(end, size));
  };
  for (int row = 0; row < cells.height(); ++row) {
    const double y = plan.origin.y() + (cells.height() - 1 - row) * plan.cell;
    const auto [first_y, end_y] = parts_in(y, truth.origin.y(), truth.cells.height());
    for (int column = 0; column < cells.width(); ++column) {
      const double x = plan.origin.x() + column * plan.cell;
      const auto [first_x, end_x] = parts_in(x, truth.origin.x(), truth.cells.width());
      int free = 0, blocked = 0;
      for (int v = first_y; v < end_y; ++v) {
        for (int u = first_x; u < end_x; ++u) {
          const std::uint8_t kind = truth.cells.at(u, truth.cells.height() - 1 - v);
          free += kind == kFree;
          blocked += kind == kBlocked;
        }
      }
      if (free + blocked > 0) cells.at(column, row) = blocked > 0 ? kBlocked : kFree;
    }
  }
  return cells;
}

template <class Predicate>
bool any_around(const ByteImage& cells, int x, int y, Predicate is) {
  for (int v = std::max(0, y - 1); v <= std::min(cells.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(cells.width() - 1, x + 1); ++u) {
      if (is(u, v)) return true;
    }
  }
  return false;
}

// For any_around(): whether a cell is of one kind.
auto is_of(const ByteImage& cells, std::uint8_t kind) {
  return [&cells, kind](int u, int v) { return cells.at(u, v) == kind; };
}

// Counts of which a share are right.
struct Share {
  int right = 0, all = 0;

  void add(bool is_right) {
    right += is_right;
    ++all;
  }
  double value() const { return all == 0 ? 1.0 : static_cast<double>(right) / all; }
};

}  // namespace

PlanScore score_plan(const OccupancyGrid& plan, const OccupancyGrid& truth) {
  const ByteImage true_cells = at_cells_of(plan, truth);
  Share free_right, free_near, blocked_right, obstacles;
  for (int y = 0; y < plan.cells.height(); ++y) {
    for (int x = 0; x < plan.cells.width(); ++x) {
      const std::uint8_t is = true_cells.at(x, y), planned = plan.cells.at(x, y);
      if (is != kFree && is != kBlocked) continue;
      const bool beside_free = is == kFree || any_around(true_cells, x, y, is_of(true_cells, kFree));
      if (planned == kFree) {
        free_right.add(is == kFree);
        free_near.add(beside_free);
      }
      if (planned == kBlocked) blocked_right.add(any_around(true_cells, x, y, is_of(true_cells, kBlocked)));
      const bool beside_known = is == kBlocked && any_around(true_cells, x, y, [&](int u, int v) {
                                  return true_cells.at(u, v) == kFree && plan.cells.at(u, v) == kFree;
                                });
      if (beside_known) obstacles.add(any_around(plan.cells, x, y, is_of(plan.cells, kBlocked)));
    }
  }
  PlanScore score{.free_right = free_right.value(),
                  .free_near = free_near.value(),
                  .blocked_right = blocked_right.value(),
                  .obstacles = obstacles.value()};
  score.free_square_metres = plan.count(kFree) * plan.cell * plan.cell;
  score.blocked_square_metres = plan.count(kBlocked) * plan.cell * plan.cell;
  return score;
}

}  // namespace penumbra::slam
