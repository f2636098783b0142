#include "slam/dynamics/rgbd/cell_repair.h"

#include <algorithm>
#include <cmath>

#include "nn/base/ceil_div.h"

namespace penumbra::slam {

namespace {

constexpr int kNoGrey = 1000;  // of a cell without depth: unlike all others
constexpr int kCellsPerWindow = 4, kMostSweeps = 4;
constexpr int kWideGuard = 3;  // times theta2, in the later sweeps

}  // namespace

// What its pixels in the image are as one sample, and which of them are holes of the box.
CellRepair::Cell CellRepair::make_cell(const ByteView& grey, const Rect& pixels, const Rect& box,
                                       const FloatImage& depth) const {
  Cell cell;
  float sum = 0.0F, nearest = kMostRepairMetres, farthest = 0.0F;
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
    const float* z = depth.row(y);
    const std::uint8_t* g = grey.row(y);
    for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
      if (can_be_used(z[x])) {
        sum += z[x];
        nearest = std::min(nearest, z[x]);
        farthest = std::max(farthest, z[x]);
        ++cell.weight;
        cell.grey += g[x];
      } else if (box.contains(x, y)) {
        ++cell.holes;
        cell.hole_grey += g[x];
      }
    }
  }
  if (cell.holes > 0) cell.hole_grey /= cell.holes;
  if (cell.weight == 0) {
    cell.grey = kNoGrey;
    return cell;
  }
  cell.grey /= cell.weight;
  cell.depth = sum / static_cast<float>(cell.weight);
  if (farthest <= nearest * static_cast<float>(1.0 + settings_.two_surfaces)) return cell;
  const float middle = std::sqrt(nearest * farthest);
  float near_sum = 0.0F;
  int near = 0;
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
    const float* z = depth.row(y);
    for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
      if (!can_be_used(z[x]) || z[x] > middle) continue;
      near_sum += z[x];
      ++near;
    }
  }
  const bool is_near = 2 * near >= cell.weight;
  cell.weight = is_near ? near : cell.weight - near;
  cell.depth = (is_near ? near_sum : sum - near_sum) / static_cast<float>(cell.weight);
  return cell;
}

// Gives it the depth of the cells around that look alike, if there are any.
void CellRepair::repair(Cell& hole, int column, int row, int guard, int farthest_away, const Size& reach,
                        const Size& grid) {
  samples_.clear();
  float nearest = kMostRepairMetres, farthest = 0.0F;
  std::int32_t weight = 0, away = farthest_away + 1;
  const int left = std::max(0, column - reach.width), right = std::min(grid.width - 1, column + reach.width);
  for (int y = std::max(0, row - reach.height); y <= std::min(grid.height - 1, row + reach.height); ++y) {
    const Cell* cells = cells_.data() + static_cast<std::ptrdiff_t>(y) * grid.width;
    for (int x = left; x <= right; ++x) {
      const Cell& cell = cells[x];
      if (std::abs(cell.grey - hole.hole_grey) >= guard) continue;
      const int steps = cell.away + std::max(std::abs(x - column), std::abs(y - row));
      if (steps > farthest_away) continue;
      samples_.push_back({cell.depth, cell.weight});
      nearest = std::min(nearest, cell.depth);
      farthest = std::max(farthest, cell.depth);
      weight += cell.weight;
      away = std::min(away, steps);
    }
  }
  if (samples_.empty()) return;
  hole.repaired = value_of_samples(nearest, farthest, weight);
  if (hole.weight > 0) return;
  hole.depth = hole.repaired;
  hole.weight = 1;
  hole.grey = hole.hole_grey;
  hole.away = away;
}

float CellRepair::value_of_samples(float nearest, float farthest, std::int32_t weight) {
  if (settings_.mode == RepairMode::median) {
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample& a, const Sample& b) { return a.depth < b.depth; });
    std::int32_t below = 0;
    for (const Sample& sample : samples_) {
      below += sample.weight;
      if (2 * below >= weight) return sample.depth;
    }
  }
  float sum = 0.0F, near_sum = 0.0F;
  std::int32_t near = 0;
  const bool two = farthest > nearest * static_cast<float>(1.0 + settings_.two_surfaces);
  const float middle = std::sqrt(nearest * farthest);
  for (const Sample& sample : samples_) {
    const float weighted = sample.depth * static_cast<float>(sample.weight);
    const bool is_near = two && sample.depth <= middle;
    sum += weighted;
    near_sum += is_near ? weighted : 0.0F;
    near += is_near ? sample.weight : 0;
  }
  if (!two) return sum / static_cast<float>(weight);
  const double votes = settings_.nearer_votes * near;
  return votes >= weight - near ? near_sum / static_cast<float>(near)
                                : (sum - near_sum) / static_cast<float>(weight - near);
}

int CellRepair::apply(const ByteView& grey, const Rect& box, const Size& reach, FloatImage& depth) {
  const Size image = depth.size();
  const int side = std::max(1, (2 * std::min(reach.width, reach.height)) / kCellsPerWindow);
  const Size cell_reach{std::max(1, reach.width / side), std::max(1, reach.height / side)};
  // From a corner outside the box on, so that its own corner is one of a cell.
  const int left = box.x - cell_reach.width * side, top = box.y - cell_reach.height * side;
  const Size grid{ceil_div(box.width, side) + 2 * cell_reach.width,
                  ceil_div(box.height, side) + 2 * cell_reach.height};
  cells_.clear();
  Cell nothing;
  nothing.grey = kNoGrey;
  int unfilled = 0;
  const auto pixels_of = [&](int column, int row) {
    return intersection({left + column * side, top + row * side, side, side},
                        {0, 0, image.width, image.height});
  };
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Rect pixels = pixels_of(column, row);
      cells_.push_back(pixels.empty() ? nothing : make_cell(grey, pixels, box, depth));
      unfilled += cells_.back().holes > 0;
    }
  }
  const int cells = grid.width * grid.height, farthest = std::max(1, settings_.farthest / side);
  for (int sweep = 0; sweep < kMostSweeps && unfilled > 0; ++sweep) {
    const int before = unfilled;
    const int guard = settings_.grey_difference * (sweep < 2 ? 1 : kWideGuard);
    for (int n = 0; n < cells; ++n) {
      const int at = sweep % 2 == 0 ? n : cells - 1 - n;
      Cell& cell = cells_[static_cast<std::size_t>(at)];
      if (cell.holes == 0 || cell.repaired > 0.0F) continue;
      repair(cell, at % grid.width, at / grid.width, guard, farthest, cell_reach, grid);
      unfilled -= cell.repaired > 0.0F;
    }
    if (unfilled == before && sweep >= 2) break;
  }
  int filled = 0;
  for (int at = 0; at < cells; ++at) {
    const Cell& cell = cells_[static_cast<std::size_t>(at)];
    if (cell.repaired == 0.0F) continue;
    const Rect pixels = intersection(pixels_of(at % grid.width, at / grid.width), box);
    for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
      for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
        float& z = depth.at(x, y);
        if (can_be_used(z)) continue;
        z = cell.repaired;
        ++filled;
      }
    }
  }
  return filled;
}

}  // namespace penumbra::slam
