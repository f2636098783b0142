#include "apps/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace penumbra::apps {

ProgressBar::ProgressBar(std::string title, int total, std::string unit)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      total_(total),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_update_(start_),
      last_draw_(start_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputc('\n', stderr);
}

void ProgressBar::update(int done) {
  constexpr std::chrono::milliseconds kRedraw(100);
  done_ = done;
  last_update_ = Clock::now();
  if (visible_ && (done_ == total_ || last_update_ - last_draw_ >= kRedraw)) draw();
}

double ProgressBar::rate() const {
  const double seconds = std::chrono::duration<double>(last_update_ - start_).count();
  return seconds > 0.0 ? done_ / seconds : 0.0;
}

void ProgressBar::draw() {
  constexpr int kWidth = 30;
  last_draw_ = last_update_;
  drawn_ = true;
  std::string line = "\r" + title_ + " ";
  if (total_ > 0) {
    const int filled = std::min(kWidth, static_cast<int>(static_cast<double>(done_) * kWidth / total_));
    std::string bar(static_cast<std::size_t>(filled), '=');
    if (filled < kWidth) bar += '>';
    bar.resize(kWidth, ' ');
    line += fmt::format("[{}] {}/{}", bar, done_, total_);
  } else {
    line += fmt::format("{}", done_);
  }
  line += fmt::format("  {:.1f} {}/s", rate(), unit_);
  if (total_ > 0 && rate() > 0.0) {
    const int left = static_cast<int>((total_ - done_) / rate() + 0.5);
    line += fmt::format("  {}:{:02d} left", left / 60, left % 60);
  }
  std::fputs((line + "\x1b[K").c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace penumbra::apps
