// The workers that share loops. Also run under ThreadSanitizer: see CONTRIBUTING.md.
#include "nn/base/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support/allocation_counter.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;

// Sets the calling thread's count for a scope.
class Threads {
 public:
  explicit Threads(int count) : before_(thread_count()) { set_thread_count(count); }
  ~Threads() { set_thread_count(before_); }

 private:
  int before_;
};

std::int64_t sum_of_first(std::int64_t count) { return count * (count - 1) / 2; }

// Every index once, whatever the counts.
void expect_each_once(std::int64_t count, std::int64_t grain) {
  std::vector<std::atomic<int>> seen(static_cast<std::size_t>(count));
  parallel_for(count, grain, [&](std::int64_t i) { ++seen[static_cast<std::size_t>(i)]; });
  for (const auto& times : seen) ASSERT_EQ(times, 1) << count << " in pieces of " << grain;
}

TEST(Parallel, EveryIndexIsVisitedOnce) {
  for (const int threads : {1, 2, 3, 7}) {
    const Threads scope(threads);
    for (const std::int64_t count : {0, 1, 2, 5, 6, 7, 100, 4097}) {
      for (const std::int64_t grain : {0, 1, 3, 64, 5000}) expect_each_once(count, grain);
    }
  }
}

TEST(Parallel, NothingIsDoneForNoOrFewerIndices) {
  const Threads scope(3);
  for (const std::int64_t count : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{-1} << 40}) {
    parallel_for(count, 1, [](std::int64_t) { FAIL(); });
  }
  parallel_for({4, 0, 3}, 1, [](int, int, int) { FAIL(); });
}

TEST(Parallel, PiecesAreOfTheGrainAndInOrder) {
  for (const int threads : {1, 2}) {
    const Threads scope(threads);
    std::mutex mutex;
    std::set<std::pair<std::int64_t, std::int64_t>> pieces;
    parallel_pieces(10, 4, [&](std::int64_t first, std::int64_t end, int) {
      const std::lock_guard lock(mutex);
      pieces.emplace(first, end);
    });
    EXPECT_EQ(pieces, (std::set<std::pair<std::int64_t, std::int64_t>>{{0, 4}, {4, 8}, {8, 10}}))
        << threads << " threads";
  }
}

TEST(Parallel, AxesAreCountedLastOneFastest) {
  for (const int threads : {1, 2, 7}) {
    const Threads scope(threads);
    std::vector<std::array<int, 3>> found(3 * 5 * 4);
    std::atomic<std::size_t> next{0};
    parallel_for({3, 5, 4}, 7, [&](int n, int b, int y) { found[next++] = {n, b, y}; });
    if (threads > 1) std::sort(found.begin(), found.end());
    for (int i = 0; i < 60; ++i) {
      ASSERT_EQ(found[static_cast<std::size_t>(i)], (std::array<int, 3>{i / 20, i / 4 % 5, i % 4}));
    }
  }
}

TEST(Parallel, SlotsAreBelowTheCountAndNotSharedAtATime) {
  for (const int threads : {1, 2, 5}) {
    const Threads scope(threads);
    std::vector<std::atomic<bool>> busy(static_cast<std::size_t>(threads));
    for (int round = 0; round < 50; ++round) {
      parallel_for({20, 4}, 1, [&](int, int, int slot) {
        ASSERT_GE(slot, 0);
        ASSERT_LT(slot, threads);
        ASSERT_FALSE(busy[static_cast<std::size_t>(slot)].exchange(true));
        if (slot % 2 == 1) std::this_thread::sleep_for(10us);
        busy[static_cast<std::size_t>(slot)] = false;
      });
    }
  }
}

TEST(Parallel, OthersHelpTheCaller) {
  const Threads scope(2);
  std::set<std::thread::id> helpers;
  std::mutex mutex;
  parallel_for(200, 1, [&](std::int64_t) {
    std::this_thread::sleep_for(100us);
    const std::lock_guard lock(mutex);
    helpers.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(helpers.size(), 2U);
}

TEST(Parallel, OneThreadStaysAlone) {
  const Threads scope(1);
  const auto self = std::this_thread::get_id();
  parallel_for(100, 1, [&](std::int64_t) { ASSERT_EQ(std::this_thread::get_id(), self); });
}

TEST(Parallel, ThreadCountIsOfEachThread) {
  const Threads scope(3);
  int seen = 0;
  std::thread([&] {
    set_thread_count(2);
    seen = thread_count();
  }).join();
  EXPECT_EQ(seen, 2);
  EXPECT_EQ(thread_count(), 3);
  set_thread_count(0);
  EXPECT_EQ(thread_count(), 1);
}

TEST(Parallel, LoopsWithinLoopsHaveTheCallersCount) {
  const Threads scope(3);
  std::atomic<std::int64_t> sum{0};
  parallel_for(40, 1, [&](std::int64_t i) {
    ASSERT_EQ(thread_count(), 3);
    parallel_for({5, 20}, 1, [&](int j, int k) {
      parallel_for(3, 1, [&](std::int64_t l) { sum += i * 300 + j * 60 + k * 3 + l; });
    });
  });
  EXPECT_EQ(sum, sum_of_first(40 * 300));
}

TEST(Parallel, ManyCallersShareTheWorkers) {
  constexpr int kCallers = 24;  // more than can share at a time
  std::vector<std::thread> callers;
  std::vector<std::int64_t> sums(kCallers);
  std::atomic<int> inner{0};
  for (std::size_t c = 0; c < kCallers; ++c) {
    callers.emplace_back([&, c] {
      set_thread_count(1 + static_cast<int>(c) % 4);
      for (int round = 0; round < 60; ++round) {
        std::vector<std::int64_t> squares(97);
        parallel_for(97, 1 + round % 5, [&](std::int64_t i) {
          if (i % 32 == 0) parallel_for(8, 1, [&](std::int64_t) { ++inner; });
          squares[static_cast<std::size_t>(i)] += i * i;
        });
        sums[c] += std::accumulate(squares.begin(), squares.end(), std::int64_t{0});
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const std::int64_t sum : sums) EXPECT_EQ(sum, 60 * (96 * 97 * 193 / 6));
  EXPECT_EQ(inner, kCallers * 60 * 4 * 8);
}

TEST(Parallel, AnExceptionReachesTheCallerAndEndsTheLoop) {
  for (const int threads : {1, 2, 7}) {
    const Threads scope(threads);
    std::atomic<int> done{0};
    try {
      parallel_for(100000, 1, [&](std::int64_t i) {
        if (i == 10) throw std::runtime_error("ten");
        ++done;
        if (i > 10) std::this_thread::sleep_for(10us);
      });
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "ten");
    }
    EXPECT_LT(done, 50000);
    expect_each_once(100, 1);  // as if nothing had happened
  }
}

TEST(Parallel, AllMayThrowAndOneIsReported) {
  const Threads scope(4);
  for (int round = 0; round < 100; ++round) {
    EXPECT_THROW(parallel_for(50, 1, [](std::int64_t i) { throw static_cast<int>(i); }), int);
  }
}

TEST(Parallel, AnExceptionOfAnInnerLoopPassesTheOuterOne) {
  const Threads scope(3);
  EXPECT_THROW(parallel_for(10, 1,
                            [](std::int64_t i) {
                              parallel_for(10, 1, [i](std::int64_t j) {
                                if (i == 5 && j == 5) throw std::logic_error("inner");
                              });
                            }),
               std::logic_error);
}

TEST(Parallel, CallsAllocateNothing) {
  const Threads scope(3);
  expect_each_once(100, 1);  // makes the workers
  std::atomic<std::int64_t> sum{0};
  const std::size_t before = test::allocation_count();
  for (int round = 0; round < 20; ++round) {
    parallel_for({10, 10}, 1, [&](int i, int j) { sum += 10 * i + j; });
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(sum, 20 * sum_of_first(100));
}

// A worker that cannot run must hold nothing up: while all are busy with somebody's long pieces, another
// caller does its work alone.
TEST(Parallel, ACallerNeedsNoWorker) {
  const Threads scope(2);
  std::atomic<bool> let_go{false};
  std::atomic<int> held{0};
  std::thread other([&] {
    set_thread_count(2);
    parallel_for(2, 1, [&](std::int64_t) {
      ++held;
      while (!let_go) std::this_thread::sleep_for(100us);
    });
  });
  while (held < 2) std::this_thread::sleep_for(100us);
  for (int round = 0; round < 100; ++round) expect_each_once(50, 1);
  let_go = true;
  other.join();
}

TEST(Parallel, WorkersOfTheBackgroundHaveItsPriority) {
  std::set<int> niceness;
  std::thread background([&] {
    run_in_background();
    set_thread_count(2);
    std::mutex mutex;
    std::set<std::thread::id> helpers;
    parallel_for(200, 1, [&](std::int64_t) {
      std::this_thread::sleep_for(100us);
      const std::lock_guard lock(mutex);
      helpers.insert(std::this_thread::get_id());
      niceness.insert(getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())));
    });
    EXPECT_EQ(helpers.size(), 2U);
  });
  background.join();
  ASSERT_EQ(niceness.size(), 1U);
  EXPECT_EQ(*niceness.begin(), std::min(getpriority(PRIO_PROCESS, 0) + 10, 19));
}

TEST(Parallel, AChildOfForkMakesItsOwnWorkers) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the sanitizer has no threads after fork()";
#endif
  const Threads scope(2);
  expect_each_once(100, 1);
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<std::int64_t> sum{0};
    std::atomic<bool> helped{false};
    const auto self = std::this_thread::get_id();
    for (int round = 0; round < 100 && !helped; ++round) {
      sum = 0;
      parallel_for(100, 1, [&](std::int64_t i) {
        sum += i;
        std::this_thread::sleep_for(10us);
        if (std::this_thread::get_id() != self) helped = true;
      });
    }
    _exit(sum == sum_of_first(100) && helped ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(ParallelDeathTest, TheProcessEndsWithIdleWorkers) {
  EXPECT_EXIT(
      {
        set_thread_count(4);
        expect_each_once(1000, 1);
        std::exit(0);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace penumbra
