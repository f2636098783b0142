#include "slam/dynamics/rgbd/depth_repair.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra::slam {

namespace {

constexpr float kUnit = 1.0F / 8192.0F;  // metres, of sums of depths
constexpr int kCountBits = 40;           // below it the sum, above it the number of depths
constexpr int kPad = 8;                  // grey values below 0 and above 255 that nothing has
constexpr int kGreys = 256 + 2 * kPad;   // a column
constexpr int kRun = 16;                 // grey values whose sums move along a run of holes

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
    return by_cells_.apply(grey, inside, reach, depth);
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
      if (!can_be_used(z)) continue;
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
      if (can_be_used(at.depth_at(x, y))) {
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

}  // namespace penumbra::slam
