// Poses as they are found, for a program that steers by them: TUM lines, one a located frame, each written at
// once.
#pragma once

#include <optional>
#include <string>

#include "slam/geometry/mounting.h"
#include "slam/pipeline/slam.h"

namespace penumbra::apps {

class PoseOutput {
 public:
  // `target`: "-" for standard output, from which all else is then turned to standard error; or a unix socket
  // that listens, unix:PATH; empty: nowhere. Poses are those of `body`, or else of the camera. Throws Error
  // where it cannot be reached.
  PoseOutput(const std::string& target, std::optional<slam::Mounting> body);
  ~PoseOutput();
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;

  // The pose of a frame that was located. A reader that is gone costs a warning, and what comes after is not
  // written.
  void add(const slam::FrameResult& frame);

 private:
  int descriptor_ = -1;
  const std::string target_;
  const std::optional<slam::Mounting> body_;
};

}  // namespace penumbra::apps
