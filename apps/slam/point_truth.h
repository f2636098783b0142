// Which features in people's boxes were judged right, on a recording of `penumbra synth --flow`: there the
// true motion of every pixel is known.
//
// A pixel's point, by its true depth and pose, would be seen at p_s in the next frame if it stood still; the
// flow says that it is seen at p. It moves where |p - p_s| is a quarter of a pixel or more (4 cm a second 3 m
// away), it stands below a twentieth; in between it does not count. A motion along the ray does not show here
// but at the middle of the picture.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/common/made_truth.h"
#include "slam/dynamics/instance.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/geometry/trajectory.h"
#include "slam/pipeline/frame_view.h"

namespace penumbra::apps {

struct JudgedPoints {
  long moving = 0, moving_left_out = 0;  // features in people's boxes
  long standing = 0, standing_kept = 0;

  double moving_recall() const;  // share; 1 where there were none
  double standing_share() const;
};

class PointTruth {
 public:
  // Nothing where the recording has no flow, true depth or instances.
  static std::optional<PointTruth> open(const std::filesystem::path& recording,
                                        const slam::StereoCamera& camera, const slam::Trajectory& truth);

  // Adds what the frame made of its features. Throws InputError for files that are not that.
  void judge(int frame, const slam::FrameView& view, JudgedPoints& count) const;

 private:
  PointTruth(const std::filesystem::path& recording, const slam::StereoCamera& camera,
             const slam::Trajectory& truth);

  slam::StereoCamera camera_;
  slam::Trajectory truth_;
  slam::Segmenter instances_;
  TrueDepths depths_;
  std::vector<std::filesystem::path> flow_;  // of frame i, to the next
};

}  // namespace penumbra::apps
