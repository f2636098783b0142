// The SLAM pipeline: stereo pairs go in, one after the other; a trajectory and a map come out.
//
//   Slam slam(dataset.camera(), settings);
//   for (int i = 0; i < dataset.size(); ++i) slam.process(dataset.load(i));
//   write(slam.trajectory());
//
// Everything is computed in the calling thread, apart from the features of the right image; results do not
// depend on the number of threads and repeat bit for bit.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slam/base/stage_timer.h"
#include "slam/datasets/stereo_dataset.h"
#include "slam/features/orb_extractor.h"
#include "slam/features/stereo_matcher.h"
#include "slam/loop/loop_closer.h"
#include "slam/mapping/local_mapper.h"
#include "slam/semantics/instance.h"
#include "slam/tracking/tracker.h"

namespace penumbra::slam {

struct SemanticsSettings {
  int interval = 1;          // every how many frames the segmenter runs
  double least_score = 0.5;  // instances below it are ignored
  int margin = 3;            // pixels around a mask that still belong to the object
};

// Every setting of the pipeline; each group is documented where it is used.
struct SlamSettings {
  OrbSettings orb;
  TrackerSettings tracker;
  LocalMapperSettings mapper;
  LoopCloserSettings loops;
  SemanticsSettings semantics;
  int threads = 2;  // 1: the right image's features wait for the left's
};

struct FrameResult {
  int index = 0;
  TrackingReport tracking;
  bool keyframe = false;
  bool closed_loop = false;
  int features = 0, stereo_features = 0, movable_features = 0;
};

class Slam {
 public:
  // `segmenter` may be empty. Throws InputError for a camera that cannot be: fx, fy or baseline not above
  // zero or not finite, an image without pixels.
  Slam(const StereoCamera& camera, const SlamSettings& settings, Segmenter segmenter = {});
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // Takes the next pair; grey or colour, of the camera's size (InputError otherwise).
  FrameResult process(const StereoImages& images);

  // Pose of every frame so far, as the map now sees it; a lost frame has the pose that was predicted for it.
  Trajectory trajectory() const;
  Trajectory keyframe_trajectory() const;

  const Map& map() const { return map_; }
  // Loops that were closed, in the order in which they were.
  const std::vector<ClosedLoop>& loops() const { return loop_closer_.loops(); }
  const LoopCloser& loop_closer() const { return loop_closer_; }
  const StageTimer& timer() const { return timer_; }
  const std::vector<FrameResult>& results() const { return results_; }
  const StereoCamera& camera() const { return camera_; }
  int tracked() const { return count(TrackingState::tracking); }
  int lost() const { return static_cast<int>(results_.size()) - tracked(); }

 private:
  struct TrajectoryEntry {
    double timestamp;
    const KeyFrame* reference;  // nullptr before the first keyframe
    SE3 T_c_reference;
  };

  std::shared_ptr<FrameFeatures> measure(const StereoImages& images);
  void mark_movable(const StereoImages& images, FrameFeatures& features);
  bool insert_keyframe(Frame& frame, bool starts_submap);
  int count(TrackingState state) const;

  const StereoCamera camera_;
  const SlamSettings settings_;
  const Segmenter segmenter_;
  StageTimer timer_;
  OrbExtractor left_orb_, right_orb_;
  Map map_;
  LocalMapper mapper_;
  LoopCloser loop_closer_;
  Tracker tracker_;
  std::vector<TrajectoryEntry> entries_;
  std::vector<FrameResult> results_;
};

}  // namespace penumbra::slam
