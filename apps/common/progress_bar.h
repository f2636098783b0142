// How far a long command is, on stderr: a bar on a terminal, elsewhere (a log, a batch system) a line every
// ten seconds.
//
//   Rendering [=========>          ]  42/100  24.8 frames/s  0:02 left
//   Rendering 42/100  24.8 frames/s  0:02 left
#pragma once

#include <chrono>
#include <string>

namespace penumbra::apps {

class ProgressBar {
 public:
  // `total` frames, 0 where unknown. `unit` is what is counted, in the plural.
  ProgressBar(std::string title, int total, std::string unit = "frames",
              std::chrono::milliseconds between_lines = std::chrono::seconds(10));
  ~ProgressBar();  // leaves the line as it is and starts the next
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // `done` frames are complete. Redraws ten times a second at most, and at the end; a log gets no line at the
  // end, which the command's results tell of.
  void update(int done);
  // Frames per second from construction to the last update.
  double rate() const;

 private:
  using Clock = std::chrono::steady_clock;

  void draw();
  std::string rate_and_rest() const;

  std::string title_, unit_;
  int total_, done_ = 0;
  std::chrono::milliseconds between_lines_;
  bool is_terminal_, drawn_ = false;
  Clock::time_point start_, last_update_, last_draw_;
};

}  // namespace penumbra::apps
