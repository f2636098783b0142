// Frames one after the other: of a recording, or as a camera takes them.
#pragma once

#include "nn/base/stage_timer.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

struct FrameStamp {
  int index = 0;
  double timestamp = 0.0;  // seconds
};

class FrameSource {
 public:
  enum class Next { frame, later, end };

  virtual ~FrameSource() = default;
  // Waits for the next frame, `seconds` at most. Later: a camera has not taken it yet.
  virtual Next wait(double seconds) = 0;
  // The next frame, after wait() has said that there is one. Throws what reading it threw, and then goes on
  // with the frame after it.
  virtual StereoImages next() = 0;
  // Of the frame that next() was called for last.
  virtual FrameStamp newest() const = 0;
  // Times of its threads, of what they have done so far.
  virtual StageTimer take_times() = 0;
};

}  // namespace penumbra::slam
