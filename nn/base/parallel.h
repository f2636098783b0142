// Loops that several threads share.
//
//   parallel_for(rows, 4, [&](int row) { ... });                    // pieces of four rows
//   parallel_for({images, blocks, rows}, 1, [&](int n, int b, int y) { ... });
//   ArenaBuffer scratch = arena.allocate(thread_count() * floats);  // for bodies with memory of their own:
//   parallel_for(count, 1, [&](int i, int slot) { use(scratch.data() + slot * floats); });
//
// The indices are cut into pieces of `grain`, on any number of threads. The calling thread and idle workers
// take piece after piece, in order, until none is left; then the call returns. Who takes which piece differs
// from run to run: a body may write what belongs to its index, and must not add to what it shares with
// others, so that results have the same bits on any number of threads. No two bodies of a call have the same
// slot at the same time; slots are below the caller's thread_count().
//
// Sharing a processor with others: the caller waits for pieces that were begun, never for a thread. A worker
// that the system keeps from running takes no piece, and one that loses its processor keeps one piece only;
// so pieces should be short (50 microseconds, say; a call costs about 5 where workers sleep). Who finds
// nothing to do looks on for some microseconds and then sleeps.
//
// Any thread may call, also at the same time as others and from within a body. An exception that a body
// throws reaches the caller once the pieces under way are done; those that have not begun are left out. A
// call allocates no memory. Workers are made when they are first asked for and live as long as the process;
// after fork() the child makes its own.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace penumbra {

// How many threads may share a loop of the calling thread. At first: what the environment variable
// OMP_NUM_THREADS says, or else the number of processors that the process may use.
int thread_count();
// For the loops of the calling thread alone; at least 1.
void set_thread_count(int threads);
// The same as long as this lives.
class ThreadCountScope {
 public:
  explicit ThreadCountScope(int threads) : before_(thread_count()) { set_thread_count(threads); }
  ThreadCountScope(const ThreadCountScope&) = delete;
  ThreadCountScope& operator=(const ThreadCountScope&) = delete;
  ~ThreadCountScope() { set_thread_count(before_); }

 private:
  const int before_;
};

// Leaves the processors to other threads where both want them: the calling thread gets a lower priority for
// good, and its loops are shared with workers of that priority.
void run_in_background();

// Indices a piece, where the body of one reads or writes so many numbers and does little else.
constexpr std::int64_t grain_of(std::int64_t numbers) {
  constexpr std::int64_t kPiece = 32 * 1024;
  return numbers < kPiece ? kPiece / (numbers > 0 ? numbers : 1) : 1;
}

namespace parallel_detail {

using Piece = void (*)(const void* body, std::int64_t first, std::int64_t end, int slot);
void run(std::int64_t count, std::int64_t grain, Piece piece, const void* body);

template <class Body, std::size_t kNumbers, std::size_t... kAxis>
void call(const Body& body, const std::array<int, kNumbers>& index, std::index_sequence<kAxis...>) {
  if constexpr (std::is_invocable_v<const Body&, decltype(index[kAxis])..., int>) {
    body(index[kAxis]..., index.back());
  } else {
    body(index[kAxis]...);
  }
}

}  // namespace parallel_detail

// body(first, end, slot) for the pieces of 0..count-1.
template <class Body>
void parallel_pieces(std::int64_t count, std::int64_t grain, const Body& body) {
  parallel_detail::run(
      count, grain,
      [](const void* b, std::int64_t first, std::int64_t end, int slot) {
        (*static_cast<const Body*>(b))(first, end, slot);
      },
      &body);
}

// body(i) or body(i, slot) for 0..count-1, i of the count's type.
template <std::integral Index, class Body>
void parallel_for(Index count, std::int64_t grain, const Body& body) {
  parallel_pieces(static_cast<std::int64_t>(count), grain,
                  [&body](std::int64_t first, std::int64_t end, [[maybe_unused]] int slot) {
                    for (auto i = static_cast<Index>(first); i < static_cast<Index>(end); ++i) {
                      if constexpr (std::is_invocable_v<const Body&, Index, int>) {
                        body(i, slot);
                      } else {
                        body(i);
                      }
                    }
                  });
}

// body(i, j, ...) or body(i, j, ..., slot) for all indices below the extents, the last one fastest.
template <std::size_t kAxes, class Body>
void parallel_for(const int (&extents)[kAxes], std::int64_t grain, const Body& body) {
  std::int64_t count = 1;
  for (const int extent : extents) count *= extent;
  parallel_pieces(count, grain, [&](std::int64_t first, std::int64_t end, int slot) {
    std::array<int, kAxes + 1> index{};  // and the slot
    index[kAxes] = slot;
    std::int64_t rest = first;
    for (std::size_t axis = kAxes; axis-- > 0; rest /= extents[axis]) {
      index[axis] = static_cast<int>(rest % extents[axis]);
    }
    for (std::int64_t i = first; i < end; ++i) {
      parallel_detail::call(body, index, std::make_index_sequence<kAxes>());
      for (std::size_t axis = kAxes; axis-- > 0 && ++index[axis] == extents[axis];) index[axis] = 0;
    }
  });
}

}  // namespace penumbra
