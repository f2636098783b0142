#include "nn/layers/nms.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>

#include "nn/layers/best_scores.h"
#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

namespace {

constexpr int kNone = -1;

BoxLanes empty_lanes(int before) {
  BoxLanes lanes{};
  std::fill(std::begin(lanes.area), std::end(lanes.area), std::numeric_limits<float>::quiet_NaN());
  lanes.before = before;
  return lanes;
}

void add(const Box& box, BoxLanes& lanes) {
  const int lane = lanes.count++;
  lanes.x1[lane] = box.x1;
  lanes.y1[lane] = box.y1;
  lanes.x2[lane] = box.x2;
  lanes.y2[lane] = box.y2;
  lanes.area[lane] = box.area();
}

// Whether the IoU with one of them is above the threshold.
bool overlaps(const BoxLanes& lanes, const Box& box, float threshold) {
  for (int l = 0; l < lanes.count; ++l) {
    if (iou({lanes.x1[l], lanes.y1[l], lanes.x2[l], lanes.y2[l]}, box) > threshold) return true;
  }
  return false;
}

// The same for all boxes of a group, whose last ones are lanes[last].
bool overlaps_any(const ArenaVector<BoxLanes>& lanes, int last, const Box& box, float threshold) {
  FindOverlapArguments a{lanes.data(), last, box.x1, box.y1, box.x2, box.y2, box.area(), threshold};
  while ((a.first = kernels().find_overlap(a)) != kNone) {
    const BoxLanes& found = lanes[static_cast<std::size_t>(a.first)];
    if (overlaps(found, box, threshold)) return true;
    a.first = found.before;
  }
  return false;
}

}  // namespace

ArenaVector<int> batched_nms(const Candidates& candidates, const NmsOptions& options, Arena& arena) {
  const std::size_t capacity = candidates.boxes.capacity();
  const std::size_t most = std::min(capacity, static_cast<std::size_t>(std::max(options.max_kept, 0)));
  ArenaVector<int> kept(arena, most);
  ArenaVector<RankKey> order(arena, capacity);
  for (std::size_t i = 0; i < candidates.scores.size(); ++i) {
    order.push_back(rank_key(candidates.scores[i], static_cast<std::uint32_t>(i)));
  }
  std::sort(order.begin(), order.end());

  // A group's last ones may be few, so there are more of them than the boxes would fill.
  const auto groups = static_cast<std::size_t>(options.groups);
  ArenaVector<BoxLanes> lanes(arena, most / kBoxLanes + std::min(most, groups));
  ArenaVector<int> last_of_group(arena, groups);
  last_of_group.resize(last_of_group.capacity());
  std::fill(last_of_group.begin(), last_of_group.end(), kNone);
  for (const RankKey key : order) {
    if (kept.size() == most) break;
    const std::size_t i = index_of(key);
    const Box& box = candidates.boxes[i];
    int& last = last_of_group[static_cast<std::size_t>(candidates.groups[i])];
    if (overlaps_any(lanes, last, box, options.threshold)) continue;
    if (last == kNone || lanes[static_cast<std::size_t>(last)].count == kBoxLanes) {
      lanes.push_back(empty_lanes(last));
      last = static_cast<int>(lanes.size()) - 1;
    }
    add(box, lanes[static_cast<std::size_t>(last)]);
    kept.push_back(static_cast<int>(i));
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
