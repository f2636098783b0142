// Reads the frames of a dataset in order, always one ahead in a thread of its own, so that decoding the
// images overlaps with the work on the frame before.
#pragma once

#include <future>
#include <utility>

#include "nn/base/stage_timer.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

class Prefetcher {
 public:
  explicit Prefetcher(const StereoDataset& dataset) : dataset_(dataset) { start(); }
  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;
  ~Prefetcher() {
    if (next_.valid()) next_.wait();
  }

  // Whether next() has a frame to give.
  bool has_next() const { return next_.valid(); }
  // The next frame; throws what loading it threw, and then goes on with the frame after it.
  StereoImages next() {
    std::future<StereoImages> current = std::move(next_);
    current.wait();
    start();
    return current.get();
  }
  // Times of its thread, which it waits for.
  StageTimer take_times() {
    if (next_.valid()) next_.wait();
    return timer_.take();
  }

 private:
  void start() {
    if (position_ >= dataset_.size()) return;
    next_ = std::async(std::launch::async, [this, i = position_] {
      const auto scope = timer_.measure("decoding");
      return dataset_.load(i);
    });
    ++position_;
  }

  const StereoDataset& dataset_;
  StageTimer timer_{"images"};
  int position_ = 0;  // frame that is read next
  std::future<StereoImages> next_;
};

}  // namespace penumbra::slam
