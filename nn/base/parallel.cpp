#include "nn/base/parallel.h"

#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace penumbra {

namespace {

using parallel_detail::Piece;

constexpr int kCalls = 16;  // at the same time; what comes beyond is done by its caller alone
// How long one looks on before it sleeps: about what sleeping and waking cost.
constexpr std::chrono::microseconds kLookOn{10};
constexpr int kNicer = 10;  // than the process is what runs in the background
constexpr std::size_t kLine = 64;

// Sleeps while `word` has the value `seen`, at most until somebody wakes; may also wake without a reason.
void sleep_while(std::atomic<std::uint32_t>& word, std::uint32_t seen) {
  syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, seen, nullptr, nullptr, 0);
}

void wake(std::atomic<std::uint32_t>& word, int threads) {
  syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, threads, nullptr, nullptr, 0);
}

// Tells the processor that this thread waits: the other thread of its core goes on meanwhile, and none of the
// reads ahead has to be undone. ARM's `yield` does nothing on most cores, `isb` waits some ten cycles.
void spin_pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb" ::: "memory");
#endif
}

// Whether `word` is still `seen` after a look.
bool look_on(const std::atomic<std::uint32_t>& word, std::uint32_t seen) {
  const auto end = std::chrono::steady_clock::now() + kLookOn;
  while (word.load(std::memory_order_acquire) == seen) {
    if (std::chrono::steady_clock::now() > end) return true;
    for (int i = 0; i < 8; ++i) spin_pause();
  }
  return false;
}

// A call whose pieces are shared. Calls are reused and never freed, so who comes late reads a call that is
// over, or another one, and does no harm: the ticket, [number of the call | next piece], is taken by a
// compare-and-exchange, which fails once the call is another. A worker that is stopped before that has begun
// nothing, and nobody waits for it.
struct Call {
  static constexpr std::uint32_t kClosed = 0xffffffff;  // as next piece: what else stands here is not valid
  alignas(kLine) std::atomic<std::uint64_t> ticket{kClosed};
  std::atomic<std::uint64_t> joined{0};                   // [number of the call | slots given]
  alignas(kLine) std::atomic<std::uint32_t> finished{0};  // pieces
  std::atomic<bool> caller_sleeps{false};
  alignas(kLine) std::atomic<bool> taken{false};
  // Written while the ticket is closed. Released each, and read before the ticket is taken: whoever sees a
  // later call's value finds the ticket changed.
  std::atomic<Piece> piece{nullptr};
  std::atomic<const void*> body{nullptr};
  std::atomic<std::int64_t> count{0}, grain{1};
  std::atomic<std::uint32_t> pieces{0};
  std::atomic<int> threads{1};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;  // of the piece that has set `failed`, until the caller takes it
};

std::uint32_t number_of(std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); }
std::uint64_t word_of(std::uint32_t number, std::uint32_t low) { return std::uint64_t{number} << 32 | low; }
std::uint32_t low_of(std::uint64_t word) { return static_cast<std::uint32_t>(word); }

// Takes pieces of `call`, while it is the one of `number`, until none is left.
void take_pieces(Call& call, std::uint32_t number, int slot) {
  std::uint64_t ticket = call.ticket.load(std::memory_order_acquire);
  while (number_of(ticket) == number && low_of(ticket) != Call::kClosed) {
    const std::uint32_t pieces = call.pieces.load(std::memory_order_acquire);
    const Piece piece = call.piece.load(std::memory_order_acquire);
    const void* body = call.body.load(std::memory_order_acquire);
    const std::int64_t count = call.count.load(std::memory_order_acquire);
    const std::int64_t grain = call.grain.load(std::memory_order_acquire);
    if (low_of(ticket) >= pieces) return;
    if (!call.ticket.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
    // Now the call is not over before this piece is.
    const std::int64_t first = grain * low_of(ticket);
    try {
      if (!call.failed.load(std::memory_order_relaxed)) {
        piece(body, first, std::min(first + grain, count), slot);
      }
    } catch (...) {
      if (!call.failed.exchange(true)) call.failure = std::current_exception();
    }
    if (call.finished.fetch_add(1) + 1 == pieces && call.caller_sleeps.load()) wake(call.finished, 1);
    ticket = call.ticket.load(std::memory_order_acquire);
  }
}

struct Pool {
  Call calls[kCalls];
  alignas(kLine) std::atomic<std::uint32_t> calls_begun{0};  // modulo 2^32: what workers watch
  std::atomic<int> sleepers{0};
  std::atomic<int> workers{0};
  std::mutex growing;
  bool background = false;
};

thread_local Pool* own_pool = nullptr;  // none yet: the foreground
thread_local int own_threads = 0;       // none yet: all

void lower_priority() {
  const int of_process = getpriority(PRIO_PROCESS, static_cast<id_t>(getpid()));
  // On Linux of this thread alone.
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), of_process + kNicer);
}

// Slot 0 is the caller's.
bool help(Call& call) {
  const std::uint64_t ticket = call.ticket.load(std::memory_order_acquire);
  if (low_of(ticket) == Call::kClosed || low_of(ticket) >= call.pieces.load(std::memory_order_acquire)) {
    return false;
  }
  const int threads = call.threads.load(std::memory_order_acquire);
  std::uint64_t joined = call.joined.load(std::memory_order_acquire);
  do {
    if (number_of(joined) != number_of(ticket) || static_cast<int>(low_of(joined)) >= threads) return false;
  } while (!call.joined.compare_exchange_weak(joined, joined + 1, std::memory_order_acq_rel));
  own_threads = threads;  // for loops within this one
  take_pieces(call, number_of(ticket), static_cast<int>(low_of(joined)));
  return true;
}

void work(Pool& pool) {
  own_pool = &pool;
  if (pool.background) lower_priority();
  while (true) {
    const std::uint32_t seen = pool.calls_begun.load(std::memory_order_acquire);
    bool helped = false;
    for (Call& call : pool.calls) helped = help(call) || helped;
    if (helped || !look_on(pool.calls_begun, seen)) continue;
    pool.sleepers.fetch_add(1);
    sleep_while(pool.calls_begun, seen);
    pool.sleepers.fetch_sub(1);
  }
}

// Both pools, which workers may read until the process is gone.
Pool* pools() {
  static Pool* const both = [] {
    auto* made = new Pool[2];
    made[1].background = true;
    // A child of fork() has no workers: it makes new ones. Calls of other threads stay open and are nobody's.
    const auto let_go = [] {
      for (Pool* pool = pools(); pool < pools() + 2; ++pool) pool->growing.unlock();
    };
    pthread_atfork(
        [] {
          for (Pool* pool = pools(); pool < pools() + 2; ++pool) pool->growing.lock();
        },
        let_go,
        [] {
          for (Pool* pool = pools(); pool < pools() + 2; ++pool) {
            pool->workers = pool->sleepers = 0;
            pool->growing.unlock();
          }
        });
    return made;
  }();
  return both;
}

// At least so many workers, if the system grants them: without, the caller does more.
void grow(Pool& pool, int workers) {
  const std::lock_guard lock(pool.growing);
  try {
    while (pool.workers.load() < workers) {
      std::thread([&pool] { work(pool); }).detach();
      ++pool.workers;
    }
  } catch (const std::system_error&) {
  }
}

int default_threads() {
  if (const char* text = std::getenv("OMP_NUM_THREADS"); text != nullptr) {
    int threads = 0;
    std::from_chars(text, text + std::strlen(text), threads);  // of a list the first: one level of loops
    if (threads > 0) return threads;
  }
  cpu_set_t usable;
  if (sched_getaffinity(0, sizeof(usable), &usable) == 0) return std::max(CPU_COUNT(&usable), 1);
  return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

// The calling thread does it all, in the same pieces: a body may have room for no more.
void run_alone(std::int64_t count, std::int64_t grain, parallel_detail::Piece piece, const void* body) {
  for (std::int64_t first = 0; first < count; first += grain)
    piece(body, first, std::min(first + grain, count), 0);
}

Call* free_call(Pool& pool) {
  for (Call& call : pool.calls) {
    if (!call.taken.load(std::memory_order_relaxed) && !call.taken.exchange(true)) return &call;
  }
  return nullptr;
}

}  // namespace

int thread_count() {
  static const int all = default_threads();
  return own_threads > 0 ? own_threads : all;
}

void set_thread_count(int threads) { own_threads = std::max(threads, 1); }

void run_in_background() {
  own_pool = pools() + 1;
  lower_priority();
}

void parallel_detail::run(std::int64_t count, std::int64_t grain, Piece piece, const void* body) {
  constexpr std::int64_t kMostPieces = 1 << 30;
  grain = std::max({grain, std::int64_t{1}, (count + kMostPieces - 1) / kMostPieces});
  if (count <= 0) return;
  const int threads = thread_count();
  if (count <= grain || threads == 1) return run_alone(count, grain, piece, body);
  Pool& pool = own_pool != nullptr ? *own_pool : *pools();
  if (pool.workers.load(std::memory_order_relaxed) < threads - 1) grow(pool, threads - 1);
  Call* const call = free_call(pool);
  if (call == nullptr) return run_alone(count, grain, piece, body);

  const std::uint32_t number = number_of(call->ticket.load()) + 1;
  const auto pieces = static_cast<std::uint32_t>((count + grain - 1) / grain);
  call->ticket.store(word_of(number, Call::kClosed));
  call->finished.store(0);
  call->piece.store(piece);
  call->body.store(body);
  call->count.store(count);
  call->grain.store(grain);
  call->pieces.store(pieces);
  call->threads.store(threads);
  call->failed.store(false);
  call->joined.store(word_of(number, 1));
  call->ticket.store(word_of(number, 0));
  pool.calls_begun.fetch_add(1);
  const int wanted =
      static_cast<int>(std::min<std::uint32_t>(pieces, static_cast<std::uint32_t>(threads))) - 1;
  if (pool.sleepers.load() > 0) wake(pool.calls_begun, wanted);

  take_pieces(*call, number, 0);
  std::uint32_t finished = call->finished.load();
  while (finished != pieces) {
    if (look_on(call->finished, finished)) {
      call->caller_sleeps.store(true);
      sleep_while(call->finished, finished);
      call->caller_sleeps.store(false);
    }
    finished = call->finished.load();
  }
  const std::exception_ptr failure = call->failed.load() ? std::exchange(call->failure, nullptr) : nullptr;
  call->taken.store(false);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace penumbra
