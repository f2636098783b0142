// One run of `penumbra slam` from its first frame to its last: feeds the pipeline and keeps, shows and tells
// what it finds.
#pragma once

#include <cstddef>

#include "apps/slam/frame_input.h"
#include "apps/slam/pose_output.h"
#include "apps/slam/slam_results.h"
#include "apps/slam/slam_run.h"
#include "apps/view/live_view.h"
#include "nn/base/stopwatch.h"
#include "slam/pipeline/dense_mapper.h"
#include "slam/pipeline/recorder.h"
#include "slam/pipeline/run_check.h"

namespace penumbra::apps {

class FrameLoop {
 public:
  // `dense`, `view`: may be null.
  FrameLoop(const SlamOptions& options, FrameInput& input, slam::Slam& slam, slam::Recorder& record,
            slam::DenseMapper* dense, LiveView* view, SlamRun& run);

  // Until the end, a signal, or an error, which is then in SlamRun::error; so is the signal that ends a
  // recording, while it is how a stream ends.
  void run(const ResultPlaces& places);

 private:
  void process();
  void tell_silence(bool has_frame);
  void tell();
  void sum_up();

  const SlamOptions& options_;
  FrameInput& input_;
  slam::Slam& slam_;
  slam::Recorder& record_;
  slam::DenseMapper* const dense_;
  LiveView* const view_;
  SlamRun& run_;
  slam::RunCheck check_;
  PoseOutput poses_;
  std::size_t reported_loops_ = 0;
  Stopwatch silence_;  // since the last frame
  bool is_silent_ = false;
};

}  // namespace penumbra::apps
