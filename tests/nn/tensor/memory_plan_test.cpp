#include "nn/tensor/memory_plan.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

void expect_disjoint(const std::vector<BufferLifetime>& buffers, const MemoryPlan& plan) {
  ASSERT_EQ(plan.offsets.size(), buffers.size());
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    EXPECT_LE(plan.offsets[i] + buffers[i].bytes, plan.bytes);
    for (std::size_t j = 0; j < i; ++j) {
      if (buffers[i].first >= buffers[j].last || buffers[j].first >= buffers[i].last) continue;
      EXPECT_TRUE(plan.offsets[i] + buffers[i].bytes <= plan.offsets[j] ||
                  plan.offsets[j] + buffers[j].bytes <= plan.offsets[i])
          << i << " and " << j;
    }
  }
}

TEST(MemoryPlan, BuffersThatLiveTogetherAreDisjointOnRandomSchedules) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<BufferLifetime> buffers(static_cast<std::size_t>(test::pick(random, 0, 40)));
    for (BufferLifetime& buffer : buffers) {
      buffer.bytes = 64 * static_cast<std::size_t>(test::pick(random, 1, 50));
      buffer.first = static_cast<std::size_t>(test::pick(random, 0, 60));
      buffer.last = buffer.first + static_cast<std::size_t>(test::pick(random, 1, 10));
    }
    const MemoryPlan plan = plan_memory(buffers);
    expect_disjoint(buffers, plan);
    EXPECT_GE(plan.bytes, most_live_bytes(buffers));
    for (const std::size_t offset : plan.offsets) EXPECT_EQ(offset % 64, 0U);
  }
}

TEST(MemoryPlan, AChainTakesItsTwoLargestNeighbours) {
  std::vector<BufferLifetime> chain;
  for (const std::size_t bytes : {64, 640, 256, 320, 128}) {
    chain.push_back({bytes, chain.size(), chain.size() + 2});
  }
  EXPECT_EQ(most_live_bytes(chain), 896U);
  EXPECT_EQ(plan_memory(chain).bytes, 896U);
}

TEST(MemoryPlan, NothingTakesNothing) {
  EXPECT_EQ(plan_memory({}).bytes, 0U);
  EXPECT_EQ(most_live_bytes({}), 0U);
}

}  // namespace
}  // namespace penumbra::nn
