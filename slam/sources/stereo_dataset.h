// A recorded stereo or RGB-D sequence, read frame by frame. Readers: see open_dataset.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/geometry/mounting.h"
#include "slam/geometry/sensor.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// One frame: two rectified images, or one image and its depth.
struct StereoImages {
  int index = 0;             // frame number in the sequence
  double timestamp = 0.0;    // seconds
  ByteImage left, right;     // grey (1 channel) or BGR (3 channels), of the camera's size
  FloatImage depth;          // instead of `right`: metres along z, 0 where unknown
  double depth_delay = 0.0;  // seconds from the colour image to the depth image
  // How the camera moved since the frame before (T_now_before), where wheels or an inertial sensor tell it: a
  // guess from which the images are compared.
  std::optional<SE3> step = std::nullopt;
};

class StereoDataset {
 public:
  virtual ~StereoDataset() = default;

  virtual std::string name() const = 0;  // for logs and reports, such as "KITTI odometry 00"
  virtual Sensor sensor() const = 0;
  // Of RGB-D cameras the baseline is nominal: it says how depth is weighed against pixels.
  virtual const StereoCamera& camera() const = 0;
  virtual int size() const = 0;  // frames
  // Number of frame `i` in the sequence, StereoImages::index.
  virtual int frame_number(int i) const = 0;
  // Time of frame `i` in seconds, without reading its images.
  virtual double timestamp(int i) const = 0;
  // Reads frame `i`, 0 <= i < size(). Throws InputError for an image that is missing, torn or of another
  // size. May be called from a thread of its own, one call at a time.
  virtual StereoImages load(int i) const = 0;
  // T_wc of the left rectified camera, where the dataset has ground truth: at most one pose a frame, with the
  // frame's time; frames whose pose is not known have none.
  virtual const std::optional<Trajectory>& ground_truth() const = 0;
  // Frames of what carries the camera in which the left rectified camera stands still, as far as they are
  // known.
  virtual const std::vector<Mounting>& mountings() const = 0;
  // What the user should know about the recording: frames that are missing, images without a partner.
  virtual const std::vector<std::string>& notes() const = 0;
};

}  // namespace penumbra::slam
