// Tells what is probably wrong with a recording or its calibration while it is run: figures that no robot
// has, images that show nothing, and why frames could not be located. It changes nothing.
//
//   RunCheck check(camera, sensor);
//   for each frame:  result = slam.process(images);  check.add(images, result);  show(check.take_warnings());
//   at the end:      show(check.why_lost());
//
// What is said, once each:
//   baseline above 3 m                        millimetres for metres?
//   speed above 100 m/s in ten frames         times in another unit, or a baseline that is too large?
//   median depth outside what sensors see     (stereo 0.1 to 500 m, RGB-D 0.1 to 20 m): baseline or depth
//   factor? images black or of one grey, left and right the same image, no features: in three frames, which
//   were not located more than half of ten or more frames lost
// Cost: a few microseconds a frame; a look at the pixels of frames that were not located.
#pragma once

#include <string>
#include <vector>

#include "nn/base/samples.h"
#include "slam/pipeline/slam.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Why a frame could not be located, the plainest reason first.
enum class LostReason {
  unreadable,
  one_grey,
  same_images,
  few_features,
  few_depths,
  covered,
  time_gap,
  no_agreement
};
inline constexpr int kLostReasons = 8;

class RunCheck {
 public:
  RunCheck(const StereoCamera& camera, Sensor sensor);

  // A frame and what became of it, in the order of the frames.
  void add(const StereoImages& images, const FrameResult& result);
  // A frame whose images could not be read.
  void add_unreadable(int index);

  // Why the frame that was added last was not located; empty where it was.
  const std::string& newest_reason() const { return newest_reason_; }
  // What there is to say since the last call.
  std::vector<std::string> take_warnings();
  // The two that follow look at all frames so far: they are for the end, and for now and then.
  // One sentence on the frames that were not located: how many, from which on, and what they have in common.
  // Empty where all were.
  std::string why_lost() const;
  // Metres at the median, of the frames' median depths; 0 where none had any.
  double median_depth() const;

 private:
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  LostReason reason_of(const StereoImages& images, const FrameResult& result) const;
  void note_lost(int index, LostReason reason);
  void check_speed(double timestamp, const FrameResult& result);
  void check_depth();

  StereoCamera camera_;
  Sensor sensor_;
  std::vector<std::string> warnings_;
  std::string newest_reason_;
  Samples depths_, steps_;  // metres, seconds
  int frames_ = 0, lost_ = 0, first_lost_ = 0, last_lost_ = 0;
  int lost_for_[kLostReasons] = {};
  bool located_ = false;                      // the last frame
  int fast_ = 0;                              // fast frames in a row
  double last_time_ = 0.0, last_step_ = 0.0;  // seconds
  Eigen::Vector3d last_place_ = Eigen::Vector3d::Zero();
};

}  // namespace penumbra::slam
