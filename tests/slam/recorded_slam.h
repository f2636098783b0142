// The pipeline with a recorder: what tests of whole runs look at.
#pragma once

#include <memory>

#include "slam/pipeline/recorder.h"

namespace penumbra::test {

class RecordedSlam : public slam::Slam {
 public:
  using Slam::Slam;

  // As Slam's; what they find is recorded.
  template <typename... Input>
  const slam::FrameResult& process(const Input&... input) {
    results_.push_back(record_.add(Slam::process(input...)));
    return results_.back();
  }
  void finish() { record_.finish(); }

  const slam::Recorder& record() const { return record_; }
  const std::vector<slam::FrameResult>& results() const { return results_; }
  slam::Trajectory trajectory() const { return record_.trajectory(); }
  std::vector<slam::SubmapSummary> submaps() const { return record_.submaps(); }
  int tracked() const { return record_.tracked(); }
  int lost() const { return record_.lost(); }

 private:
  std::vector<slam::FrameResult> results_;
  slam::Recorder record_{*this};
};

}  // namespace penumbra::test
