#include "slam/frontend/disparity/matching_cost.h"

#include <algorithm>
#include <vector>

#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

// Of 24 bits. std::popcount would be a call for each number where vectors have no such instruction.
std::uint8_t count_bits(std::uint32_t bits) {
  bits -= (bits >> 1U) & 0x555555U;
  bits = (bits & 0x333333U) + ((bits >> 2U) & 0x333333U);
  bits = (bits + (bits >> 4U)) & 0x0F0F0FU;
  return static_cast<std::uint8_t>(bits + (bits >> 8U) + (bits >> 16U));
}

}  // namespace

void matching_cost(const CensusImage& left, const CensusImage& right, int disparities,
                   DisparityVolume<std::uint8_t>& cost) {
  const int width = left.width();
  cost.create(width, left.height(), disparities);
  parallel_pieces(left.height(), 8, [&](std::int64_t first, std::int64_t end, int) {
    // The right row backwards, so that the columns which x - d runs through lie in order.
    std::vector<std::uint32_t> backwards(static_cast<std::size_t>(width));
    for (int y = static_cast<int>(first); y < static_cast<int>(end); ++y) {
      std::reverse_copy(right.row(y), right.row(y) + width, backwards.begin());
      for (int x = 0; x < width; ++x) {
        const std::uint32_t from = left.at(x, y);
        const std::uint32_t* __restrict const to = backwards.data() + (width - 1 - x);
        std::uint8_t* __restrict const costs = cost.at(x, y);
        const int inside = std::min(disparities, x + 1);
        for (int d = 0; d < inside; ++d) costs[d] = count_bits(from ^ to[d]);
        std::fill(costs + inside, costs + disparities, static_cast<std::uint8_t>(kCensusBits));
      }
    }
  });
}

}  // namespace penumbra::slam
