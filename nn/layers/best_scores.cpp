#include "nn/layers/best_scores.h"

#include <algorithm>

namespace penumbra::nn {

namespace {

float score_of(RankKey key) {
  constexpr std::uint32_t kSign = 0x80000000U;
  const auto falling = static_cast<std::uint32_t>(key >> 32);
  return std::bit_cast<float>((falling & kSign) != 0 ? falling : ~falling & ~kSign);
}

}  // namespace

void BestScores::leave_best() {
  least_ = std::numeric_limits<float>::infinity();
  if (count_ > 0) {
    RankKey* const last = keys_.begin() + count_ - 1;
    std::nth_element(keys_.begin(), last, keys_.end());
    least_ = score_of(*last);
  }
  keys_.resize(count_);
}

std::span<const RankKey> BestScores::sorted() {
  if (keys_.size() > count_) leave_best();
  std::sort(keys_.begin(), keys_.end());
  return keys_.span();
}

}  // namespace penumbra::nn
