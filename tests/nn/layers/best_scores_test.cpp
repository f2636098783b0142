#include "nn/layers/best_scores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::pick;

std::vector<std::uint32_t> best_of(const std::vector<float>& scores, std::size_t count) {
  Arena arena;
  BestScores best(arena, count);
  for (std::size_t i = 0; i < scores.size(); ++i) best.offer(scores[i], static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> indices;
  for (const RankKey key : best.sorted()) indices.push_back(index_of(key));
  return indices;
}

// By the header's words, of all at once.
std::vector<std::uint32_t> sorted_of(const std::vector<float>& scores, std::size_t count) {
  std::vector<std::uint32_t> order(scores.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return scores[a] > scores[b] || (std::isnan(scores[b]) && !std::isnan(scores[a]));
  });
  order.resize(std::min(count, order.size()));
  return order;
}

TEST(BestScores, AreTheFirstOfAllSorted) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> odd{NAN, -NAN, kInfinity, -kInfinity, 0.0F, -0.0F, 1e-45F, -1e-45F, -3e38F};
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int count = pick(random, 0, 600);
    std::vector<float> scores;
    for (int i = 0; i < count; ++i) {
      const int kind = pick(random, 0, 9);
      scores.push_back(kind == 0   ? odd[static_cast<std::size_t>(pick(random, 0, 8))]
                       : kind == 1 ? 0.25F * static_cast<float>(pick(random, -4, 4))  // with ties
                                   : std::normal_distribution<float>()(random));
    }
    // Also in the orders that keep fewest and most.
    const auto number = [](float score) { return std::isnan(score) ? -1e9F : score; };
    const auto less = [&](float x, float y) { return number(x) < number(y); };
    if (trial % 3 > 0) std::sort(scores.begin(), scores.end(), less);
    if (trial % 3 > 1) std::reverse(scores.begin(), scores.end());
    const auto wanted = static_cast<std::size_t>(pick(random, 0, 80));
    EXPECT_EQ(best_of(scores, wanted), sorted_of(scores, wanted));
  }
}

TEST(BestScores, OfNothingButNanAreTheFirst) {
  EXPECT_EQ(best_of(std::vector<float>(100, NAN), 3), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(BestScores, AskedForMoreThanThereAreGivesAll) {
  EXPECT_EQ(best_of({1.0F, 3.0F, 2.0F}, 1000), (std::vector<std::uint32_t>{1, 2, 0}));
}

}  // namespace
}  // namespace penumbra::nn
