// A progress bar on stderr for commands that go through frames; silent where stderr is no terminal.
//
//   Rendering [=========>          ]  42/100  24.8 frames/s  0:02 left
#pragma once

#include <chrono>
#include <string>

namespace penumbra::apps {

class ProgressBar {
 public:
  // `total` frames, 0 where unknown. `unit` is what is counted, in the plural.
  ProgressBar(std::string title, int total, std::string unit = "frames");
  ~ProgressBar();  // leaves the line as it is and starts the next
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // `done` frames are complete. Redraws ten times a second at most, and at the end.
  void update(int done);
  // Frames per second from construction to the last update.
  double rate() const;

 private:
  using Clock = std::chrono::steady_clock;

  void draw();

  std::string title_, unit_;
  int total_, done_ = 0;
  bool visible_, drawn_ = false;
  Clock::time_point start_, last_update_, last_draw_;
};

}  // namespace penumbra::apps
