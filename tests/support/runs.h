// Overlap of masks given as COCO's run lengths.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace penumbra::test {

// Intersection over union of two masks given as runs over the same image; 1 where both are empty.
inline double mask_iou(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::uint64_t both = 0, either = 0;
  std::size_t i = 0, j = 0;
  std::uint64_t left_a = a[0], left_b = b[0];
  while (true) {
    while (left_a == 0 && i + 1 < a.size()) left_a = a[++i];
    while (left_b == 0 && j + 1 < b.size()) left_b = b[++j];
    const std::uint64_t step = std::min(left_a, left_b);
    if (step == 0) break;
    const bool in_a = i % 2 == 1, in_b = j % 2 == 1;
    both += in_a && in_b ? step : 0;
    either += in_a || in_b ? step : 0;
    left_a -= step;
    left_b -= step;
  }
  return either == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(either);
}

}  // namespace penumbra::test
