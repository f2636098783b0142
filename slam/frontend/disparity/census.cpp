#include "slam/frontend/disparity/census.h"

#include <algorithm>
#include <array>

#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

constexpr int kReach = 2;  // pixels around the middle

}  // namespace

void census_transform(const ByteView& grey, CensusImage& out) {
  out.create(grey.width, grey.height);
  parallel_for(grey.height, 8, [&](int y) {
    std::array<const std::uint8_t*, 2 * kReach + 1> rows;
    for (int dy = -kReach; dy <= kReach; ++dy)
      rows[static_cast<std::size_t>(dy + kReach)] = grey.row(std::clamp(y + dy, 0, grey.height - 1));
    std::uint32_t* const bits = out.row(y);
    const std::uint8_t* const middle = rows[kReach];
    std::fill_n(bits, grey.width, 0U);
    for (int dy = -kReach; dy <= kReach; ++dy) {
      const std::uint8_t* const row = rows[static_cast<std::size_t>(dy + kReach)];
      for (int dx = -kReach; dx <= kReach; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const auto add = [&](int x, int at) { bits[x] = 2U * bits[x] + (row[at] < middle[x] ? 1U : 0U); };
        const int first = std::min(std::max(0, -dx), grey.width);
        const int end = std::max(first, grey.width - std::max(0, dx));
        for (int x = 0; x < first; ++x) add(x, 0);
        for (int x = first; x < end; ++x) add(x, x + dx);
        for (int x = end; x < grey.width; ++x) add(x, grey.width - 1);
      }
    }
  });
}

}  // namespace penumbra::slam
