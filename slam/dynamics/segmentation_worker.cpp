#include "slam/dynamics/segmentation_worker.h"

#include <algorithm>
#include <utility>

#include "nn/base/parallel.h"

namespace penumbra::slam {

SegmentationWorker::SegmentationWorker(Segmenter segmenter, bool threaded, int threads)
    : segmenter_(std::move(segmenter)), threaded_(threaded), threads_(threads) {
  if (segmenter_ && threaded_) thread_ = std::thread([this] { run(); });
}

SegmentationWorker::~SegmentationWorker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SegmentationWorker::submit(const ImageToSegment& image) {
  if (!segmenter_) return;
  if (!threaded_) {
    done_.push_back(segment(image));
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    dropped_ += waiting_.has_value();
    waiting_ = image;
    submitted_ = std::chrono::steady_clock::now();
  }
  changed_.notify_all();
}

void SegmentationWorker::keep_pace(double seconds) {
  constexpr double kLongest = 3600.0;  // times in a file may jump
  const std::chrono::duration<double> pause(std::clamp(seconds, 0.0, kLongest));
  std::unique_lock lock(mutex_);
  const auto until = submitted_ + std::chrono::duration_cast<std::chrono::nanoseconds>(pause);
  changed_.wait_until(lock, until, [&] { return is_idle(); });
}

std::vector<SegmentedFrame> SegmentationWorker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

void SegmentationWorker::drain() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_idle(); });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

int SegmentationWorker::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

SegmentedFrame SegmentationWorker::segment(const ImageToSegment& image) {
  const auto scope = timer_.measure("segmentation");
  return {image.frame, segmenter_(image)};
}

void SegmentationWorker::run() {
  run_in_background();
  set_thread_count(threads_);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ending_ || waiting_; });
    if (ending_) return;
    const ImageToSegment image = std::move(*waiting_);
    waiting_.reset();
    working_ = true;
    lock.unlock();
    SegmentedFrame found;
    std::exception_ptr failure;
    try {
      found = segment(image);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    working_ = false;
    if (failure) {
      failure_ = failure;
    } else {
      done_.push_back(std::move(found));
    }
    changed_.notify_all();
  }
}

}  // namespace penumbra::slam
