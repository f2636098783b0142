// Non-maximum suppression: of boxes that overlap, keep the one with the best score.
//
// In order of falling score (equal scores: lower index first), a box is kept unless its IoU with a kept box
// of the same group is above the threshold. Groups are classes in the box head and levels in the RPN. Cost:
// O(kept x candidates) overlaps. Source: torchvision.ops.batched_nms; reference/nms.cpp is the oracle.
#pragma once

#include <span>
#include <vector>

#include "nn/layers/box.h"

namespace penumbra::nn {

// Indices of the kept boxes in order of falling score, at most `max_kept` of them. The three spans are of one
// size.
std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept);

}  // namespace penumbra::nn
