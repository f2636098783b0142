// A square room with papered walls, for whole runs of the brain-inspired SLAM: images of it take a
// millisecond, and every place of it looks its own way.
#pragma once

#include <opencv2/core.hpp>

#include "slam/brain/landmarks/landmark.h"
#include "slam/brain/motion/odometry_noise.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::test {

class TexturedRoom {
 public:
  static constexpr double kHalf = 10.0;   // metres, from the middle to a wall
  static constexpr double kRadius = 5.0;  // of the way round the middle

  explicit TexturedRoom(std::uint64_t seed = 1);

  const slam::StereoCamera& camera() const { return camera_; }
  // Where the robot is after `metres` of the way, in the room's frame; it looks along the way.
  static slam::brain::PlanePose pose(double metres);
  slam::StereoImages images(const slam::brain::PlanePose& pose, int index) const;
  // Signs on the walls that can be seen from there, each with its own descriptor.
  slam::brain::Landmarks landmarks(const slam::brain::PlanePose& pose) const;
  // True poses of `frames` frames, `step` metres and 0.1 s apart, the first at `begin` metres.
  static slam::Trajectory truth(double begin, double step, int frames);

 private:
  struct Hit {
    double depth = 0.0, along = 0.0;  // metres: along the camera's axis, along the walls
  };
  Hit hit(const slam::brain::PlanePose& eye, double slope) const;
  ByteImage view(const slam::brain::PlanePose& eye) const;

  slam::StereoCamera camera_;
  cv::Mat paper_;
  std::uint64_t seed_;
};

}  // namespace penumbra::test
