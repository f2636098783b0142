#include "apps/common/interruption.h"

#include <string.h>
#include <time.h>

#include <atomic>

namespace penumbra::apps {

namespace {

// Milliseconds. A second signal so soon means it, unless it is the same one: a terminal or a batch system
// signals every process of a group, and the script among them passes it on.
constexpr long kTogether = 3000, kSame = 250;

std::atomic<int> signal_seen{0};
std::atomic<long> seen_at{0};  // milliseconds
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<long>::is_always_lock_free);

// Only what POSIX allows in a signal handler.
void note(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const long milliseconds = 1000 * now.tv_sec + now.tv_nsec / 1000000;
  const long since = milliseconds - seen_at.load();
  const int before = signal_seen.exchange(signal);
  if (before == signal && since < kSame) return;
  seen_at.store(milliseconds);
  if (before == 0 || since >= kTogether) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

Interruption::Interruption() {
  signal_seen = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    action.sa_handler = kSignals[i] == SIGPIPE ? SIG_IGN : note;
    action.sa_flags = SA_RESTART;
    sigaction(kSignals[i], nullptr, &before_[i]);
    const bool stays_ignored = kSignals[i] == SIGHUP && before_[i].sa_handler == SIG_IGN;
    if (!stays_ignored) sigaction(kSignals[i], &action, nullptr);
  }
}

Interruption::~Interruption() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
}

bool Interruption::requested() { return signal_seen != 0; }

std::string Interruption::signal_name() {
  if (signal_seen == 0) return {};
  const char* name = sigabbrev_np(signal_seen);  // "TERM"
  return name != nullptr ? std::string("SIG") + name : "a signal";
}

}  // namespace penumbra::apps
