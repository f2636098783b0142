// A trajectory that is written pose by pose, in KITTI's or TUM's format (slam/geometry/trajectory_io.h): 64
// kB of memory, however long it is. The file is there whole or not at all, from commit() on.
#pragma once

#include <filesystem>

#include "nn/base/file_in_the_making.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::slam {

class TrajectoryFile {
 public:
  // kitti or tum. Each function throws Error where the file cannot be written.
  TrajectoryFile(const std::filesystem::path& path, TrajectoryFormat format);
  void add(const TimedPose& pose);
  void commit() { text_.commit(); }

 private:
  const TrajectoryFormat format_;
  nn::TextInTheMaking text_;
};

}  // namespace penumbra::slam
