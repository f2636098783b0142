#include "nn/tensor/memory_plan.h"

#include <algorithm>
#include <numeric>

namespace penumbra::nn {

namespace {

bool overlap(const BufferLifetime& a, const BufferLifetime& b) {
  return a.first < b.last && b.first < a.last;
}

// Offset for `buffer` among those placed before it, which are ordered by offset.
std::size_t smallest_gap(const BufferLifetime& buffer, std::span<const BufferLifetime> buffers,
                         const std::vector<std::size_t>& placed, const std::vector<std::size_t>& offsets) {
  std::size_t free_from = 0, best = 0, best_gap = 0;
  bool found = false;
  for (const std::size_t i : placed) {
    if (!overlap(buffer, buffers[i])) continue;
    if (offsets[i] > free_from) {
      const std::size_t gap = offsets[i] - free_from;
      if (gap >= buffer.bytes && (!found || gap < best_gap)) {
        found = true;
        best = free_from;
        best_gap = gap;
      }
    }
    free_from = std::max(free_from, offsets[i] + buffers[i].bytes);
  }
  return found ? best : free_from;
}

}  // namespace

MemoryPlan plan_memory(std::span<const BufferLifetime> buffers) {
  std::vector<std::size_t> order(buffers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return buffers[a].bytes > buffers[b].bytes; });

  MemoryPlan plan;
  plan.offsets.resize(buffers.size());
  std::vector<std::size_t> placed;  // by offset
  for (const std::size_t i : order) {
    plan.offsets[i] = smallest_gap(buffers[i], buffers, placed, plan.offsets);
    plan.bytes = std::max(plan.bytes, plan.offsets[i] + buffers[i].bytes);
    const auto behind = std::upper_bound(placed.begin(), placed.end(), i, [&](std::size_t a, std::size_t b) {
      return plan.offsets[a] < plan.offsets[b];
    });
    placed.insert(behind, i);
  }
  return plan;
}

std::size_t most_live_bytes(std::span<const BufferLifetime> buffers) {
  std::size_t most = 0;
  // The most bytes live where some buffer's life begins.
  for (const BufferLifetime& start : buffers) {
    std::size_t live = 0;
    for (const BufferLifetime& buffer : buffers) {
      if (buffer.first <= start.first && start.first < buffer.last) live += buffer.bytes;
    }
    most = std::max(most, live);
  }
  return most;
}

}  // namespace penumbra::nn
