#include "apps/common/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace penumbra::apps {

ProgressBar::ProgressBar(std::string title, int total, std::string unit,
                         std::chrono::milliseconds between_lines)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      total_(total),
      between_lines_(between_lines),
      is_terminal_(isatty(STDERR_FILENO) == 1),
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
  const auto since = last_update_ - last_draw_;
  if (is_terminal_ ? done_ == total_ || since >= kRedraw : since >= between_lines_) draw();
}

double ProgressBar::rate() const {
  const double seconds = std::chrono::duration<double>(last_update_ - start_).count();
  return seconds > 0.0 ? done_ / seconds : 0.0;
}

std::string ProgressBar::rate_and_rest() const {
  std::string text = fmt::format("  {:.1f} {}/s", rate(), unit_);
  if (total_ > 0 && rate() > 0.0) {
    const int left = static_cast<int>((total_ - done_) / rate() + 0.5);
    text += fmt::format("  {}:{:02d} left", left / 60, left % 60);
  }
  return text;
}

void ProgressBar::draw() {
  constexpr int kWidth = 30;
  last_draw_ = last_update_;
  const std::string count = total_ > 0 ? fmt::format("{}/{}", done_, total_) : fmt::format("{}", done_);
  std::string line;
  if (is_terminal_) {
    drawn_ = true;
    std::string bar;
    if (total_ > 0) {
      const int filled = std::min(kWidth, static_cast<int>(static_cast<double>(done_) * kWidth / total_));
      bar.assign(static_cast<std::size_t>(filled), '=');
      if (filled < kWidth) bar += '>';
      bar.resize(kWidth, ' ');
      bar = "[" + bar + "] ";
    }
    line = "\r" + title_ + " " + bar + count + rate_and_rest() + "\x1b[K";
  } else {
    line = title_ + " " + count + rate_and_rest() + "\n";
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace penumbra::apps
