#include "slam/dynamics/segmentation_worker.h"

#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace penumbra::slam {

namespace {

// Leaves the processors to the tracker and the mapper where both want them. Linux: of this thread only.
void lower_priority() {
  constexpr int kNiceness = 10;
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
}

}  // namespace

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
  }
  changed_.notify_all();
}

std::vector<SegmentedFrame> SegmentationWorker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

void SegmentationWorker::drain() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return failure_ || (!waiting_ && !working_); });
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
  lower_priority();
  omp_set_num_threads(threads_);  // of this thread's loops only
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
