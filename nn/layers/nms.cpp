#include "nn/layers/nms.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace penumbra::nn {

namespace {

constexpr int kNone = -1;
constexpr int kLanes = 8;

// Kept boxes of one group, side by side, so that a candidate is compared with all of them in vector code.
struct KeptBoxes {
  float x1[kLanes], y1[kLanes], x2[kLanes], y2[kLanes], area[kLanes];
  int count;
  int before;  // the group's boxes kept before these; kNone for none
};

void add(const Box& box, KeptBoxes& kept) {
  const int lane = kept.count++;
  kept.x1[lane] = box.x1;
  kept.y1[lane] = box.y1;
  kept.x2[lane] = box.x2;
  kept.y2[lane] = box.y2;
  kept.area[lane] = box.area();
}

// Whether the IoU with one of them is above the threshold: iou() of box.h, lane by lane.
bool overlaps(const KeptBoxes& kept, const Box& box, float threshold) {
  const float area = box.area();
  float ious[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const float width = std::max(std::min(kept.x2[l], box.x2) - std::max(kept.x1[l], box.x1), 0.0F);
    const float height = std::max(std::min(kept.y2[l], box.y2) - std::max(kept.y1[l], box.y1), 0.0F);
    const float intersection = width * height;
    const float all = kept.area[l] + area - intersection;
    ious[l] = all > 0.0F ? intersection / all : 0.0F;
  }
  bool any = false;
  for (int l = 0; l < kept.count; ++l) any = any || ious[l] > threshold;
  return any;
}

// Which score goes first; NaN, which no order holds, goes last.
bool better(float a, float b) { return a > b || (b != b && a == a); }

}  // namespace

ArenaVector<int> batched_nms(const Candidates& candidates, const NmsOptions& options, Arena& arena) {
  const std::size_t capacity = candidates.boxes.capacity();
  const std::size_t most = std::min(capacity, static_cast<std::size_t>(std::max(options.max_kept, 0)));
  ArenaVector<int> kept(arena, most);
  ArenaVector<int> order(arena, capacity);
  order.resize(candidates.boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const float score_a = candidates.scores[static_cast<std::size_t>(a)];
    const float score_b = candidates.scores[static_cast<std::size_t>(b)];
    if (better(score_a, score_b)) return true;
    return !better(score_b, score_a) && a < b;
  });

  // A group's last ones may be few, so there are more of them than the boxes would fill.
  const auto groups = static_cast<std::size_t>(options.groups);
  ArenaVector<KeptBoxes> boxes(arena, most / kLanes + std::min(most, groups));
  ArenaVector<int> last_of_group(arena, groups);
  last_of_group.resize(last_of_group.capacity());
  std::fill(last_of_group.begin(), last_of_group.end(), kNone);
  for (const int i : order) {
    if (kept.size() == most) break;
    const Box& box = candidates.boxes[static_cast<std::size_t>(i)];
    int& last = last_of_group[static_cast<std::size_t>(candidates.groups[static_cast<std::size_t>(i)])];
    int rivals = last;
    while (rivals != kNone && !overlaps(boxes[static_cast<std::size_t>(rivals)], box, options.threshold)) {
      rivals = boxes[static_cast<std::size_t>(rivals)].before;
    }
    if (rivals != kNone) continue;
    if (last == kNone || boxes[static_cast<std::size_t>(last)].count == kLanes) {
      boxes.push_back(KeptBoxes{{}, {}, {}, {}, {}, 0, last});
      last = static_cast<int>(boxes.size()) - 1;
    }
    add(box, boxes[static_cast<std::size_t>(last)]);
    kept.push_back(i);
  }
  return kept;
}

std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept) {
  Arena arena;
  Candidates candidates(arena, boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) candidates.add(boxes[i], scores[i], groups[i]);
  const int count = groups.empty() ? 0 : *std::max_element(groups.begin(), groups.end()) + 1;
  const ArenaVector<int> kept = batched_nms(candidates, {threshold, max_kept, count}, arena);
  return {kept.begin(), kept.end()};
}

}  // namespace penumbra::nn
