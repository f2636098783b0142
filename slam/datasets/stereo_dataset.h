// A recorded stereo sequence, read frame by frame. Readers: KITTI odometry.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "slam/geometry/stereo_camera.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// One rectified stereo pair: 8-bit, grey (1 channel) or BGR (3 channels), both of the camera's size.
struct StereoImages {
  int index = 0;           // frame number in the sequence
  double timestamp = 0.0;  // seconds
  cv::Mat left, right;
};

class StereoDataset {
 public:
  virtual ~StereoDataset() = default;

  virtual std::string name() const = 0;  // for logs and reports, such as "KITTI odometry 00"
  virtual const StereoCamera& camera() const = 0;
  virtual int size() const = 0;  // frames
  // Time of frame `i` in seconds, without reading its images.
  virtual double timestamp(int i) const = 0;
  // Reads frame `i`, 0 <= i < size(). Throws InputError for an image that is missing, torn or of another
  // size. May be called from a thread of its own, one call at a time.
  virtual StereoImages load(int i) const = 0;
  // One pose per frame where the dataset has ground truth.
  virtual const std::optional<Trajectory>& ground_truth() const = 0;
};

}  // namespace penumbra::slam
