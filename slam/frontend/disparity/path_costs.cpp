#include "slam/frontend/disparity/path_costs.h"

#include <algorithm>
#include <limits>

namespace penumbra::slam {

namespace {

// Numbers before the first disparity and behind the last, where d - 1 and d + 1 are read. One would do; eight
// of them, 16 bytes, leave the L of every place aligned to vectors.
constexpr int kBorder = 8;
constexpr std::int16_t kFar = 0x3FFF;  // above any L + P1
constexpr int kDirections = 4;         // from the row before: behind, straight, ahead; and in the row itself

// L of a pixel from that of the one before, added to `sum`. Returns min L.
std::int16_t go_on(const std::uint8_t* __restrict cost, const std::int16_t* __restrict before,
                   std::int16_t least_before, const PathPenalties& penalties, int disparities,
                   std::int16_t* __restrict now, std::int16_t* __restrict sum) {
  const auto slope = static_cast<std::int16_t>(penalties.slope);
  const auto jump = static_cast<std::int16_t>(least_before + penalties.edge);
  std::int16_t least = std::numeric_limits<std::int16_t>::max();
  for (int d = 0; d < disparities; ++d) {
    const auto sloping = static_cast<std::int16_t>(std::min(before[d - 1], before[d + 1]) + slope);
    const std::int16_t best = std::min(std::min(before[d], sloping), jump);
    const auto path = static_cast<std::int16_t>(cost[d] + best - least_before);
    now[d] = path;
    sum[d] = static_cast<std::int16_t>(sum[d] + path);
    least = std::min(least, path);
  }
  return least;
}

}  // namespace

void PathPass::run(const DisparityVolume<std::uint8_t>& cost, const PathPenalties& penalties, Way way,
                   DisparityVolume<std::int16_t>& sum) {
  const int width = cost.width(), height = cost.height(), disparities = cost.disparities();
  sum.create(width, height, disparities);
  // Places of a row: one outside on either side, whose L and minimum are 0, so that L = C beside it.
  const std::size_t places = static_cast<std::size_t>(width) + 2;
  const std::size_t stride = static_cast<std::size_t>(disparities) + 2 * kBorder;
  paths_.assign(2 * kDirections * places * stride, 0);
  least_.assign(2 * kDirections * places, 0);
  const auto place_of = [&](int row, int direction, int x) {
    return (static_cast<std::size_t>(row & 1) * kDirections + static_cast<std::size_t>(direction)) * places +
           static_cast<std::size_t>(x + 1);
  };
  for (std::size_t place = 0; place < least_.size(); ++place) {
    std::int16_t* const path = paths_.data() + place * stride + kBorder;
    path[-1] = path[disparities] = kFar;
  }
  const int step = way == Way::down ? 1 : -1;
  for (int row = 0; row < height; ++row) {
    const int y = way == Way::down ? row : height - 1 - row;
    for (int i = 0; i < width; ++i) {
      const int x = way == Way::down ? i : width - 1 - i;
      std::int16_t* const total = sum.at(x, y);
      std::fill_n(total, disparities, std::int16_t{0});
      for (int direction = 0; direction < kDirections; ++direction) {
        const bool along = direction == kDirections - 1;
        const std::size_t from =
            place_of(along ? row : row + 1, direction, along ? x - step : x + (direction - 1) * step);
        const std::size_t to = place_of(row, direction, x);
        least_[to] = go_on(cost.at(x, y), paths_.data() + from * stride + kBorder, least_[from], penalties,
                           disparities, paths_.data() + to * stride + kBorder, total);
      }
    }
  }
}

}  // namespace penumbra::slam
