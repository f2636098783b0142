#include "nn/layers/nms.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace penumbra::nn {

namespace {

// A kept box, and the one kept before it of its group.
struct Kept {
  Box box;
  int before;  // -1 for none
};

constexpr int kNone = -1;

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

  ArenaVector<Kept> boxes(arena, most);  // those of `kept`
  ArenaVector<int> last_of_group(arena, static_cast<std::size_t>(options.groups));
  last_of_group.resize(last_of_group.capacity());
  std::fill(last_of_group.begin(), last_of_group.end(), kNone);
  for (const int i : order) {
    if (kept.size() == most) break;
    const Box& box = candidates.boxes[static_cast<std::size_t>(i)];
    int& last = last_of_group[static_cast<std::size_t>(candidates.groups[static_cast<std::size_t>(i)])];
    int rival = last;
    while (rival != kNone && !(iou(boxes[static_cast<std::size_t>(rival)].box, box) > options.threshold)) {
      rival = boxes[static_cast<std::size_t>(rival)].before;
    }
    if (rival != kNone) continue;
    boxes.push_back({box, last});
    last = static_cast<int>(kept.size());
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
