// Keeps what a long command has computed when it is asked to end: Ctrl-C (SIGINT), `kill` and batch systems
// (SIGTERM), a closed terminal (SIGHUP).
//
//   const Interruption interruption;
//   while (work is left) { if (Interruption::requested()) break; ... }
//   write what is there
//
// While it lives the first signal only sets a flag; a second one within 3 s ends the process at once, but not
// the same within 0.25 s, which a script has passed on. A pipe that nobody reads any more
// (`penumbra ... | head`) does not end the process either. Under `nohup` SIGHUP stays ignored. One at a time.
#pragma once

#include <array>
#include <csignal>
#include <string>

namespace penumbra::apps {

class Interruption {
 public:
  Interruption();
  ~Interruption();  // puts back what was there
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  static bool requested();
  // "SIGTERM", for messages; empty where none came.
  static std::string signal_name();

 private:
  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2, SIGPIPE};
  struct sigaction before_[kSignals.size()];
};

}  // namespace penumbra::apps
