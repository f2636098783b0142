// Where buffers go in one block of memory when it is known for how long each of them is in use.
//
// A schedule's steps are numbered; buffer i is in use in the steps first_i <= t < last_i. Wanted are offsets
// o_i with
//   [o_i, o_i + b_i) and [o_j, o_j + b_j) disjoint wherever the lifetimes of i and j overlap,
// and a block max_i (o_i + b_i) as small as can be. No plan is smaller than max_t sum_{i in use at t} b_i,
// the most bytes that live at a time. The best plan is hard to find (the problem is NP-hard); the greedy one
// is good:
//   largest buffer first, each goes into the smallest gap that it fits into between those placed before it
//   that live at the same time, or behind them.
//
// Cost: O(n^2) for n buffers. Source: Pisarchyk and Lee 2020, Efficient Memory Management for Deep Neural Net
// Inference, "greedy by size".
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace penumbra::nn {

struct BufferLifetime {
  std::size_t bytes;        // a multiple of the alignment that the offset shall have
  std::size_t first, last;  // steps: from `first` until before `last`
};

struct MemoryPlan {
  std::vector<std::size_t> offsets;  // bytes, one a buffer
  std::size_t bytes = 0;             // of the block
};

MemoryPlan plan_memory(std::span<const BufferLifetime> buffers);

// The lower bound of every plan.
std::size_t most_live_bytes(std::span<const BufferLifetime> buffers);

}  // namespace penumbra::nn
