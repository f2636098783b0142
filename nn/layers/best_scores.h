// The order of scores, and the best K of many.
//
//   A score goes before all smaller ones, and before those of its value that have a greater index; NaN goes
//   last, and -0 is 0.
//
//   BestScores best(arena, 1000);
//   for (...) best.offer(score, index);            // indices in rising order
//   for (const RankKey key : best.sorted()) ... index_of(key) ...
//
// Cost: a comparison a score, and some more for those above the K-th best so far, which is found anew
// (std::nth_element) whenever there are more than 2 K. In random order about K log(N / K) of N scores are
// above it; in rising order all are, and take part in two selections each. Sorting: K log K.
// sorted_of in tests/nn/layers/best_scores_test.cpp is the oracle.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

// A score's bits, turned so that rising keys are falling scores, and below them its index.
using RankKey = std::uint64_t;

inline RankKey rank_key(float score, std::uint32_t index) {
  constexpr std::uint32_t kSign = 0x80000000U;
  const auto bits = std::bit_cast<std::uint32_t>(score + 0.0F);  // no -0
  // Of two numbers below 0 the greater one has the smaller bits.
  const std::uint32_t falling = (bits & kSign) != 0 ? bits : ~(bits | kSign);
  return RankKey{std::isnan(score) ? ~std::uint32_t{0} : falling} << 32 | index;
}
inline std::uint32_t index_of(RankKey key) { return static_cast<std::uint32_t>(key); }

class BestScores {
 public:
  BestScores(Arena& arena, std::size_t count) : count_(count), keys_(arena, 2 * count + 1) {}

  // Each index is greater than the one before.
  void offer(float score, std::uint32_t index) {
    if (score <= least_) return;
    keys_.push_back(rank_key(score, index));
    if (keys_.size() == keys_.capacity()) leave_best();
  }
  // The best of what was offered; the last call.
  std::span<const RankKey> sorted();

 private:
  void leave_best();

  std::size_t count_;
  ArenaVector<RankKey> keys_;
  // The K-th best so far: equal ones come too late. NaN, which compares with nothing, as long as all count.
  float least_ = std::numeric_limits<float>::quiet_NaN();
};

}  // namespace penumbra::nn
