// Non-maximum suppression: of boxes that overlap, keep the one with the best score.
//
// In order of falling score (equal scores: lower index first), a box is kept unless its IoU with a kept box
// of the same group is above the threshold. Groups are classes in the box head and levels in the RPN. Cost:
// O(kept x candidates) overlaps. Source: torchvision.ops.batched_nms; reference/regions.cpp is the oracle.
#pragma once

#include <span>
#include <vector>

#include "nn/layers/box.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

// Boxes that compete, at most `capacity` of them.
struct Candidates {
  ArenaVector<Box> boxes;
  ArenaVector<float> scores;
  ArenaVector<int> groups;  // 0, 1, ...

  Candidates(Arena& arena, std::size_t capacity)
      : boxes(arena, capacity), scores(arena, capacity), groups(arena, capacity) {}
  void add(const Box& box, float score, int group) {
    boxes.push_back(box);
    scores.push_back(score);
    groups.push_back(group);
  }
};

struct NmsOptions {
  float threshold;  // of the IoU
  int max_kept;
  int groups;  // the candidates' are below
};

// Indices of the kept boxes in order of falling score.
ArenaVector<int> batched_nms(const Candidates& candidates, const NmsOptions& options, Arena& arena);

// The same for lists of one size; groups are any numbers of 0 and more.
std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept);

}  // namespace penumbra::nn
