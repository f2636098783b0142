#include "nn/tensor/arena.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {
namespace {

// A chain of layers: each output in its own buffer, the input given back behind it. Every buffer is filled,
// and checked when it is given back.
void run_chain(Arena& arena, const std::vector<std::size_t>& counts) {
  struct Filled {
    ArenaBuffer buffer;
    std::size_t count = 0;
    float value = 0.0F;
  };
  const auto check = [](const Filled& filled) {
    for (std::size_t i = 0; i < filled.count; ++i) ASSERT_EQ(filled.buffer.data()[i], filled.value);
  };
  Filled input;
  for (const std::size_t count : counts) {
    Filled output{arena.allocate(count), count, input.value + 1.0F};
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(output.buffer.data()) % 64, 0U);
    std::fill_n(output.buffer.data(), count, output.value);
    check(input);
    input = std::move(output);
  }
  check(input);
}

void run_pass(Arena& arena, int height, const std::vector<std::size_t>& counts) {
  const Arena::Pass pass(arena, &arena, height, 1);
  run_chain(arena, counts);
}

const std::vector<std::size_t> kCounts{16, 160, 64, 80, 32};  // 64, 640, 256, 320, 128 bytes

TEST(Arena, TheSecondPassReplaysThePlanOfTheFirstInOneBlock) {
  Arena arena;
  run_pass(arena, 1, kCounts);
  EXPECT_EQ(arena.recordings(), 1U);
  EXPECT_EQ(arena.bytes(), 896U);
  for (int i = 0; i < 3; ++i) run_pass(arena, 1, kCounts);
  EXPECT_EQ(arena.recordings(), 1U);
  EXPECT_EQ(arena.bytes(), 896U);
  EXPECT_EQ(arena.peak_bytes(), 896U);
}

TEST(Arena, ShapesThatAlternateKeepTheirPlans) {
  Arena arena;
  for (int round = 0; round < 3; ++round) {
    run_pass(arena, 1, kCounts);
    run_pass(arena, 2, {32, 320, 128});
    run_pass(arena, 3, {16});
  }
  EXPECT_EQ(arena.recordings(), 3U);
  EXPECT_EQ(arena.bytes(), 1792U) << "one block, as large as the largest plan";
}

TEST(Arena, TheShapeUnusedForLongestIsForgotten) {
  Arena arena;
  for (int shape = 0; shape < 17; ++shape) run_pass(arena, shape, {16});
  EXPECT_EQ(arena.recordings(), 17U);
  run_pass(arena, 1, {16});
  EXPECT_EQ(arena.recordings(), 17U);
  run_pass(arena, 0, {16});
  EXPECT_EQ(arena.recordings(), 18U);
}

TEST(Arena, APassThatStraysIsCorrectAndTheNextOneIsRecorded) {
  Arena arena;
  const std::vector<std::vector<std::size_t>> strays{{16, 1600, 64}, {16}, {}, {16, 160, 64, 80, 32, 500}};
  std::size_t recordings = 0;
  for (const std::vector<std::size_t>& stray : strays) {
    run_pass(arena, 1, kCounts);
    run_pass(arena, 1, kCounts);
    recordings = arena.recordings();
    run_pass(arena, 1, stray);
    EXPECT_EQ(arena.recordings(), recordings) << "it was meant to be a replay";
  }
  EXPECT_GE(recordings, 3U);
}

TEST(Arena, BuffersThatAreKeptLongerThanPlannedAreNotOverwritten) {
  Arena arena;
  const auto run = [&](bool keep) {
    const Arena::Pass pass(arena, &arena, 1, 1);
    ArenaBuffer kept = arena.allocate(16);
    std::fill_n(kept.data(), 16, 7.0F);
    if (!keep) kept = ArenaBuffer();
    const ArenaBuffer late = arena.allocate(16);
    std::fill_n(late.data(), 16, 9.0F);
    EXPECT_EQ(keep ? kept.data()[0] : 7.0F, 7.0F);
  };
  for (const bool keep : {false, false, true, true, true, false, false}) run(keep);
}

TEST(Arena, ABufferThatOutlivesItsPassKeepsItsContents) {
  Arena arena;
  ArenaBuffer survivor;
  for (int i = 0; i < 4; ++i) {
    ArenaBuffer last;
    {
      const Arena::Pass pass(arena, &arena, 1, 1);
      last = arena.allocate(16);
      std::fill_n(last.data(), 16, static_cast<float>(i));
      run_chain(arena, kCounts);
    }
    EXPECT_EQ(i > 0 ? survivor.data()[15] : -1.0F, static_cast<float>(i - 1));
    survivor = std::move(last);
  }
}

TEST(Arena, AnExceptionInAPassLeavesTheArenaUsable) {
  Arena arena;
  for (int i = 0; i < 3; ++i) {
    try {
      const Arena::Pass pass(arena, &arena, 1, 1);
      const ArenaBuffer buffer = arena.allocate(16);
      throw std::runtime_error("as a layer may");
    } catch (const std::runtime_error&) {
    }
    run_pass(arena, 1, kCounts);
    run_pass(arena, 1, kCounts);
  }
  EXPECT_EQ(arena.bytes(), 896U);
}

TEST(Arena, APassInsideAPassIsPartOfIt) {
  Arena arena;
  for (int i = 0; i < 2; ++i) {
    const Arena::Pass outer(arena, &arena, 1, 1);
    run_chain(arena, {16});
    run_pass(arena, 2, kCounts);
    run_chain(arena, {16});
  }
  EXPECT_EQ(arena.recordings(), 1U);
}

TEST(Arena, BuffersOutsideOfPassesAndEmptyOnesHaveMemoryOfTheirOwn) {
  Arena arena;
  {
    const ArenaBuffer a = arena.allocate(1), b = arena.allocate(0);
    EXPECT_NE(a.data(), b.data());
    EXPECT_EQ(arena.bytes(), 128U);
  }
  EXPECT_EQ(arena.bytes(), 0U);
  EXPECT_EQ(arena.peak_bytes(), 128U);
}

TEST(ArenaVector, HoldsItsCapacityAndNoMore) {
  Arena arena;
  ArenaVector<double> vector(arena, 3);
  for (int i = 0; i < 3; ++i) vector.push_back(i);
  EXPECT_THROW(vector.push_back(3.0), std::length_error);
  EXPECT_THROW(vector.resize(4), std::length_error);
  EXPECT_EQ(std::vector(vector.begin(), vector.end()), (std::vector{0.0, 1.0, 2.0}));
  vector.clear();
  EXPECT_TRUE(vector.empty());
}

}  // namespace
}  // namespace penumbra::nn
