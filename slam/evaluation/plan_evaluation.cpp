#include "slam/evaluation/plan_evaluation.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam {

namespace {

constexpr std::uint8_t kFree = OccupancyGrid::kFree, kBlocked = OccupancyGrid::kBlocked;

// What the truth says of the plan's cells.
ByteImage at_cells_of(const OccupancyGrid& plan, const OccupancyGrid& truth) {
  ByteImage cells = ByteImage::filled(plan.cells.width(), plan.cells.height(), OccupancyGrid::kUnknown);
  // Places of the truth's cells whose middles lie in a span of the plan, along one axis.
  const auto first_in = [&](double metres, double origin) {
    return static_cast<int>(std::ceil((metres - origin) / truth.cell - 0.5));
  };
  for (int row = 0; row < cells.height(); ++row) {
    const double y = plan.origin.y() + (cells.height() - 1 - row) * plan.cell;
    for (int column = 0; column < cells.width(); ++column) {
      const double x = plan.origin.x() + column * plan.cell;
      int free = 0, blocked = 0;
      // Where the truth's cells are the larger ones, the one that the middle lies in.
      int first_x = first_in(x, truth.origin.x()), end_x = first_in(x + plan.cell, truth.origin.x());
      int first_y = first_in(y, truth.origin.y()), end_y = first_in(y + plan.cell, truth.origin.y());
      if (first_x == end_x) {
        first_x = static_cast<int>(std::floor((x + 0.5 * plan.cell - truth.origin.x()) / truth.cell));
        end_x = first_x + 1;
      }
      if (first_y == end_y) {
        first_y = static_cast<int>(std::floor((y + 0.5 * plan.cell - truth.origin.y()) / truth.cell));
        end_y = first_y + 1;
      }
      for (int v = std::max(0, first_y); v < std::min(end_y, truth.cells.height()); ++v) {
        for (int u = std::max(0, first_x); u < std::min(end_x, truth.cells.width()); ++u) {
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
  const auto is_true = [&](std::uint8_t kind) {
    return [&true_cells, kind](int u, int v) { return true_cells.at(u, v) == kind; };
  };
  const auto is_planned = [&](std::uint8_t kind) {
    return [&plan, kind](int u, int v) { return plan.cells.at(u, v) == kind; };
  };
  Share free_right, free_near, blocked_right, obstacles;
  for (int y = 0; y < plan.cells.height(); ++y) {
    for (int x = 0; x < plan.cells.width(); ++x) {
      const std::uint8_t is = true_cells.at(x, y), planned = plan.cells.at(x, y);
      if (is != kFree && is != kBlocked) continue;
      const bool beside_free = is == kFree || any_around(true_cells, x, y, is_true(kFree));
      if (planned == kFree) {
        free_right.add(is == kFree);
        free_near.add(beside_free);
      }
      if (planned == kBlocked) blocked_right.add(any_around(true_cells, x, y, is_true(kBlocked)));
      const bool beside_known = is == kBlocked && any_around(true_cells, x, y, [&](int u, int v) {
                                  return true_cells.at(u, v) == kFree && plan.cells.at(u, v) == kFree;
                                });
      if (beside_known) obstacles.add(any_around(plan.cells, x, y, is_planned(kBlocked)));
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
