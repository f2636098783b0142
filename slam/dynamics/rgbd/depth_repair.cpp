#include "slam/dynamics/rgbd/depth_repair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nn/base/ceil_div.h"

namespace penumbra::slam {

namespace {

constexpr float kUnit = 1.0F / 8192.0F;  // metres, of sums of depths
constexpr int kCountBits = 40;           // below it the sum, above it the number of depths
constexpr int kPad = 8;                  // grey values below 0 and above 255 that nothing has
constexpr int kGreys = 256 + 2 * kPad;   // a column
constexpr int kRun = 16;                 // grey values whose sums move along a run of holes
constexpr float kMostMetres = 500.0F;    // so that no sum runs over
constexpr int kNoGrey = 1000;            // of a cell without depth: unlike all others
constexpr int kCellsPerWindow = 4, kMostSweeps = 4;
constexpr int kWideGuard = 3;  // times theta2, in the later sweeps

bool has_depth(float metres) { return metres > 0.0F && metres < kMostMetres; }

std::uint64_t entry(float metres) {
  return (std::uint64_t{1} << kCountBits) + static_cast<std::uint64_t>(metres * (1.0F / kUnit) + 0.5F);
}

float mean_of(std::uint64_t sums) {
  constexpr std::uint64_t kSum = (std::uint64_t{1} << kCountBits) - 1;
  return static_cast<float>(static_cast<double>(sums & kSum) / static_cast<double>(sums >> kCountBits) *
                            static_cast<double>(kUnit));
}

// The image from one corner of a rectangle on: (0, 0) is that corner, either the first or the last pixel.
struct CellCorner {
  const std::uint8_t* grey = nullptr;
  float* depth = nullptr;
  std::ptrdiff_t grey_x = 1, grey_y = 0, depth_x = 1, depth_y = 0;

  CellCorner(const ByteView& g, FloatImage& d, const Rect& area, bool backward)
      : grey_y(g.pitch), depth_y(d.pitch()) {
    const int x = backward ? area.x + area.width - 1 : area.x;
    const int y = backward ? area.y + area.height - 1 : area.y;
    grey = g.row(y) + x;
    depth = d.row(y) + x;
    if (!backward) return;
    for (std::ptrdiff_t* step : {&grey_x, &grey_y, &depth_x, &depth_y}) *step = -*step;
  }
  int grey_at(int x, int y) const { return grey[y * grey_y + x * grey_x]; }
  float& depth_at(int x, int y) const { return depth[y * depth_y + x * depth_x]; }
};

}  // namespace

Size repair_reach(const Size& box) {
  return {std::max(4, box.width / 10) / 2, std::max(4, box.height / 10) / 2};
}

int DepthRepair::apply(const ByteView& grey, const Rect& box, FloatImage& depth) {
  const Rect inside = intersection(box, {0, 0, depth.width(), depth.height()});
  if (settings_.mode == RepairMode::off || inside.empty()) return 0;
  const Size reach = repair_reach({box.width, box.height});
  if (settings_.mode == RepairMode::median || settings_.mode == RepairMode::modes)
    return repair_by_cells(grey, inside, reach, depth);
  fills_.clear();
  int filled = sweep(grey, inside, reach, /*backward=*/false, depth);
  if (settings_.mode == RepairMode::border) filled += sweep(grey, inside, reach, /*backward=*/true, depth);
  for (const auto& [pixel, metres] : fills_) *pixel = metres;
  return filled;
}

int DepthRepair::sweep(const ByteView& grey, const Rect& box, const Size& reach, bool backward,
                       FloatImage& depth) {
  const bool reuses = settings_.mode == RepairMode::border;
  // The columns and rows that windows can see, from the corner where the sweep begins.
  const Rect seen = intersection(
      {box.x - reach.width, box.y - reach.height, box.width + 2 * reach.width, box.height + 2 * reach.height},
      {0, 0, depth.width(), depth.height()});
  const CellCorner at(grey, depth, seen, backward);
  const int first_x = backward ? seen.x + seen.width - box.x - box.width : box.x - seen.x;
  const int first_y = backward ? seen.y + seen.height - box.y - box.height : box.y - seen.y;
  columns_.assign(static_cast<std::size_t>(seen.width) * kGreys, 0);
  const auto column = [&](int x) { return columns_.data() + static_cast<std::ptrdiff_t>(x) * kGreys; };
  const auto move_row = [&](int y, bool enters) {
    if (y < 0 || y >= seen.height) return;
    for (int x = 0; x < seen.width; ++x) {
      const float z = at.depth_at(x, y);
      if (!has_depth(z)) continue;
      std::uint64_t& sums = column(x)[kPad + at.grey_at(x, y)];
      sums = enters ? sums + entry(z) : sums - entry(z);
    }
  };
  for (int y = first_y - reach.height; y < first_y + reach.height; ++y) move_row(y, true);

  const int near = settings_.grey_difference - 1;  // grey values on each side
  int filled = 0;
  for (int y = first_y; y < first_y + box.height; ++y) {
    move_row(y + reach.height, true);
    move_row(y - reach.height - 1, false);
    std::array<std::uint64_t, kRun> run{};  // of the window around the pixel before
    int base = 0;                           // of its grey values, as the columns have them
    bool goes_on = false;
    for (int x = first_x; x < first_x + box.width; ++x) {
      if (has_depth(at.depth_at(x, y))) {
        goes_on = false;
        continue;
      }
      const int value = kPad + at.grey_at(x, y);
      if (goes_on && value - near >= base && value + near < base + kRun) {
        const int enters = x + reach.width, leaves = x - reach.width - 1;
        if (enters < seen.width) {
          const std::uint64_t* sums = column(enters) + base;
          for (int b = 0; b < kRun; ++b) run[static_cast<std::size_t>(b)] += sums[b];
        }
        if (leaves >= 0) {
          const std::uint64_t* sums = column(leaves) + base;
          for (int b = 0; b < kRun; ++b) run[static_cast<std::size_t>(b)] -= sums[b];
        }
      } else {
        base = value - kRun / 2;
        run = {};
        for (int c = std::max(0, x - reach.width); c <= std::min(seen.width - 1, x + reach.width); ++c) {
          const std::uint64_t* sums = column(c) + base;
          for (int b = 0; b < kRun; ++b) run[static_cast<std::size_t>(b)] += sums[b];
        }
        goes_on = true;
      }
      std::uint64_t sums = 0;
      for (int b = value - near; b <= value + near; ++b) sums += run[static_cast<std::size_t>(b - base)];
      if (sums == 0) continue;
      ++filled;
      const float metres = mean_of(sums);
      float& pixel = at.depth_at(x, y);
      if (!reuses) {
        fills_.emplace_back(&pixel, metres);
        continue;
      }
      pixel = metres;
      column(x)[value] += entry(metres);
      run[static_cast<std::size_t>(value - base)] += entry(metres);
    }
  }
  return filled;
}

// What its pixels in the image are as one sample, and which of them are holes of the box.
DepthRepair::Cell DepthRepair::make_cell(const ByteView& grey, const Rect& pixels, const Rect& box,
                                         const FloatImage& depth) const {
  Cell cell;
  float sum = 0.0F, nearest = kMostMetres, farthest = 0.0F;
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
    const float* z = depth.row(y);
    const std::uint8_t* g = grey.row(y);
    for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
      if (has_depth(z[x])) {
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
      if (!has_depth(z[x]) || z[x] > middle) continue;
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
void DepthRepair::repair(Cell& hole, int column, int row, int guard, int farthest_away, const Size& reach,
                         const Size& grid) {
  samples_.clear();
  float nearest = kMostMetres, farthest = 0.0F;
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

float DepthRepair::value_of_samples(float nearest, float farthest, std::int32_t weight) {
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

int DepthRepair::repair_by_cells(const ByteView& grey, const Rect& box, const Size& reach,
                                 FloatImage& depth) {
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
        if (has_depth(z)) continue;
        z = cell.repaired;
        ++filled;
      }
    }
  }
  return filled;
}

}  // namespace penumbra::slam
