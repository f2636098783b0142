// Runs the segmenter beside the tracker: a thread with a queue of one image, in which the newest wins.
//
//   frame -> submit -> [ waiting image ] -> segmenter -> take() -> labels, some frames later
//
// The tracker never waits: an image that arrives while another waits takes its place, and what the network
// finds is taken whenever it is there. The thread has a lower priority than the others.
//
// In line (threaded = false) submit() segments before it returns; the result is there for the next take().
// Results then depend on nothing but the images.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/dynamics/instance.h"

namespace penumbra::slam {

struct SegmentedFrame {
  int frame = 0;
  std::vector<Instance> instances;
};

class SegmentationWorker {
 public:
  // `segmenter` may be empty: nothing is ever found. `threads`: what its network may use where `threaded`.
  SegmentationWorker(Segmenter segmenter, bool threaded, int threads = 1);
  // Waits for the image under way, drops the one that waits.
  ~SegmentationWorker();
  SegmentationWorker(const SegmentationWorker&) = delete;
  SegmentationWorker& operator=(const SegmentationWorker&) = delete;

  bool enabled() const { return static_cast<bool>(segmenter_); }
  // Rethrows what the segmenter has thrown at an earlier image. The pixels are shared, and must not be
  // changed.
  void submit(const ImageToSegment& image);
  // For who plays a recording faster than it was taken: waits while an image is being segmented, but not
  // beyond `seconds` after it was submitted. A frame that was taken so much later then finds what it would
  // find if the camera were live.
  void keep_pace(double seconds);
  // What was found since the last call, oldest first.
  std::vector<SegmentedFrame> take();
  // Waits until no image is left.
  void drain();

  int dropped() const;  // images that a newer one has displaced
  // Times of the stage "segmentation". Only after drain().
  StageTimer take_times() { return timer_.take(); }

 private:
  bool is_idle() const { return failure_ || (!waiting_ && !working_); }
  void run();
  SegmentedFrame segment(const ImageToSegment& image);

  const Segmenter segmenter_;
  const bool threaded_;
  const int threads_;
  StageTimer timer_{"segmentation"};

  mutable std::mutex mutex_;         // of what follows
  std::condition_variable changed_;  // of any of it
  std::optional<ImageToSegment> waiting_;
  std::chrono::steady_clock::time_point submitted_;  // the newest image
  std::vector<SegmentedFrame> done_;
  bool working_ = false, ending_ = false;
  int dropped_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace penumbra::slam
