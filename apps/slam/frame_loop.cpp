#include "apps/slam/frame_loop.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <future>

#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

using Clock = std::chrono::steady_clock;

// Writes what there is so far every --checkpoint seconds, or less often, so that writing goes on for a
// twentieth of the time at most. What needs the map is done between two frames, and what the files need on a
// thread of its own.
class Checkpoints {
 public:
  explicit Checkpoints(double seconds) : between_(seconds), next_(Clock::now() + between_) {}
  ~Checkpoints() {
    if (writing_.valid()) writing_.wait();
  }
  bool is_due() {
    if (between_.count() <= 0.0) return false;
    if (writing_.valid()) {
      if (writing_.wait_for(Seconds(0.0)) != std::future_status::ready) return false;
      next_ = writing_.get();
    }
    return Clock::now() >= next_;
  }
  void write(const ResultPlaces& places, const slam::Recorder& record, const SlamRun& run) {
    const Clock::time_point begin = Clock::now();
    next_ = begin + between_;
    guarded([&] {
      writing_ = std::async(std::launch::async,
                            [begin, between = between_, write_all = write_checkpoint(places, record, run)] {
                              constexpr double kWorkPerWriting = 20.0;
                              guarded(write_all);
                              const Time end = Clock::now();
                              return end + std::max(between, kWorkPerWriting * Seconds(end - begin));
                            });
    });
  }

 private:
  using Seconds = std::chrono::duration<double>;
  using Time = std::chrono::time_point<Clock, Seconds>;

  template <class Work>
  static void guarded(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      log_warning("checkpoint: {}", error.what());
    }
  }

  const Seconds between_;
  Time next_;
  std::future<Time> writing_;  // and when the next is due
};

}  // namespace

FrameLoop::FrameLoop(const SlamOptions& options, FrameInput& input, slam::Slam& slam, slam::Recorder& record,
                     slam::DenseMapper* dense, LiveView* view, SlamRun& run)
    : options_(options),
      input_(input),
      slam_(slam),
      record_(record),
      dense_(dense),
      view_(view),
      run_(run),
      check_(input.dataset().camera(), input.dataset().sensor()),
      poses_(options.poses, run.body) {}

void FrameLoop::run(const ResultPlaces& places) {
  constexpr double kPatience = 0.1;  // seconds, for a stream's next frame, until signals are looked at
  slam::FrameSource& frames = input_.frames();
  ProgressBar progress("Tracking", input_.dataset().size());
  Checkpoints checkpoints(options_.checkpoint);
  while (run_.error.empty()) {
    if (Interruption::requested()) {
      // A stream ends when its user says so.
      if (!input_.is_live()) {
        run_.error = fmt::format("interrupted by {} after {}", Interruption::signal_name(),
                                 counted(record_.frames().size(), "frame"));
      }
      break;
    }
    try {
      const slam::FrameSource::Next next = frames.wait(kPatience);
      if (next == slam::FrameSource::Next::end) break;
      tell_silence(next == slam::FrameSource::Next::frame);
      if (next == slam::FrameSource::Next::later) continue;
      process();
    } catch (const std::exception& error) {
      run_.error = error.what();
    }
    tell();
    progress.update(static_cast<int>(record_.frames().size()));
    if (checkpoints.is_due()) {
      sum_up();
      checkpoints.write(places, record_, run_);
    }
  }
  run_.input_times.merge(frames.take_times());
  if (dense_ != nullptr) run_.dense_times.merge(dense_->take_times());
  sum_up();
}

// The next frame, or what stands for it where its images cannot be read.
void FrameLoop::process() {
  slam::FrameSource& frames = input_.frames();
  std::optional<slam::StereoImages> images;
  try {
    images = frames.next();
  } catch (const InputError& error) {
    if (options_.strict) throw;
    log_warning("{}; the frame is taken as lost", error.what());
  }
  slam::FrameResult result;
  if (images) {
    if (!input_.is_live()) slam_.keep_pace(images->timestamp);
    result = slam_.process(*images);
    check_.add(*images, result);
  } else {
    result = slam_.process_missing(frames.newest().index, frames.newest().timestamp);
    check_.add_unreadable(result.index);
    run_.unreadable_frames.push_back(result.index);
  }
  if (dense_ != nullptr && images && dense_->add(input_.dataset().camera(), *images, result))
    record_.keep_masks_of(result.index);
  poses_.add(result);
  // A stream may never end, and a checkpoint writes all of it: of its frames less is kept.
  if (input_.is_live()) result.tracking.filter.bins = {};
  const slam::FrameResult& kept = record_.add(std::move(result));
  if (view_ != nullptr) view_->add(kept, images ? images->left : ByteImage());
  if (kept.tracking.state == slam::TrackingState::lost) log_warning("frame {}: lost", kept.index);
  if (kept.tracking.recovered) log_info("frame {}: found again", kept.index);
}

// Of a stream: that no frames come, and that they do again.
void FrameLoop::tell_silence(bool has_frame) {
  constexpr double kSilence = 2.0;  // seconds
  const double silent = silence_.milliseconds() / 1e3;
  if (!has_frame && !is_silent_ && silent > kSilence) {
    is_silent_ = true;
    log_warning("{}: no frame for {:.0f} s; waiting", input_.dataset().name(), silent);
  }
  if (!has_frame) return;
  if (is_silent_) log_info("{}: frames again after {:.1f} s", input_.dataset().name(), silent);
  is_silent_ = false;
  silence_ = Stopwatch();
}

void FrameLoop::tell() {
  for (const std::string& warning : check_.take_warnings()) {
    log_warning("{}", warning);
    run_.warnings.push_back(warning);
  }
  const std::vector<slam::ClosedLoop> loops = slam_.loops();
  for (; reported_loops_ < loops.size(); ++reported_loops_) {
    const slam::ClosedLoop& loop = loops[reported_loops_];
    log_info("frame {}: loop with frame {} closed, {}, {:.2f} m", loop.frame, loop.earlier_frame,
             counted(loop.inliers, "point"), loop.correction_metres);
  }
}

// What takes a look at all frames so far.
void FrameLoop::sum_up() {
  run_.median_depth = check_.median_depth();
  run_.why_lost = check_.why_lost();
}

}  // namespace penumbra::apps
