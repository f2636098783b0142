#include "nn/layers/nms.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <unordered_map>

namespace penumbra::nn {

std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept) {
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return scores[static_cast<std::size_t>(a)] > scores[static_cast<std::size_t>(b)];
  });

  std::vector<int> kept;
  std::unordered_map<int, std::vector<Box>> kept_of_group;
  for (const int i : order) {
    if (static_cast<int>(kept.size()) == max_kept) break;
    const auto index = static_cast<std::size_t>(i);
    const Box& box = boxes[index];
    std::vector<Box>& rivals = kept_of_group[groups[index]];
    const bool suppressed = std::any_of(rivals.begin(), rivals.end(),
                                        [&](const Box& rival) { return iou(rival, box) > threshold; });
    if (suppressed) continue;
    rivals.push_back(box);
    kept.push_back(i);
  }
  return kept;
}

}  // namespace penumbra::nn
