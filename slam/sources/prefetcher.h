// Reads the frames of a dataset in order, always one ahead in a thread of its own, so that decoding the
// images overlaps with the work on the frame before.
#pragma once

#include <future>
#include <utility>

#include "slam/sources/frame_source.h"

namespace penumbra::slam {

class Prefetcher final : public FrameSource {
 public:
  explicit Prefetcher(const StereoDataset& dataset) : dataset_(dataset) { start(); }
  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;
  ~Prefetcher() override {
    if (next_.valid()) next_.wait();
  }

  // Whether next() has a frame to give.
  bool has_next() const { return next_.valid(); }
  Next wait(double) override { return has_next() ? Next::frame : Next::end; }
  StereoImages next() override {
    std::future<StereoImages> current = std::move(next_);
    current.wait();
    newest_ = position_ - 1;
    start();
    return current.get();
  }
  FrameStamp newest() const override { return {dataset_.frame_number(newest_), dataset_.timestamp(newest_)}; }
  StageTimer take_times() override {
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
  int position_ = 0, newest_ = 0;  // frame that is read next, and that was given last
  std::future<StereoImages> next_;
};

}  // namespace penumbra::slam
