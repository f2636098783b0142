// The SLAM pipeline: stereo pairs, or images with their depth, go in, one after the other; a trajectory and a
// map come out.
//
//   Slam slam(dataset.camera(), dataset.sensor(), settings);
//   Recorder record(slam);
//   for (int i = 0; i < dataset.size(); ++i) record.add(slam.process(dataset.load(i)));
//   record.finish();
//   write(record.trajectory());
//
// What is found of a frame is returned and not kept: only the map grows, with the ground that is new. Who
// needs the frames later keeps them (slam/pipeline/recorder.h).
//
// Tracking never waits for mapping, loop closing, the adjustment of the whole map or the segmenter, which
// have their own threads (slam/backend/map_worker.h, slam/dynamics/segmentation_worker.h). With
// SlamSettings::deterministic all of it happens in the calling thread, apart from the features of the right
// image; then results do not depend on the number of threads and repeat bit for bit: a segmented frame's
// instances are known when the next frame comes.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/backend/loop_closer.h"
#include "slam/backend/map_worker.h"
#include "slam/dynamics/instance_tracker.h"
#include "slam/dynamics/movers.h"
#include "slam/dynamics/segmentation_worker.h"
#include "slam/dynamics/static_points.h"
#include "slam/frontend/locating/tracker.h"
#include "slam/geometry/trajectory.h"
#include "slam/pipeline/feature_measurer.h"
#include "slam/pipeline/frame_view.h"
#include "slam/pipeline/slam_settings.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Where a frame is relative to a keyframe. When the map is corrected, keyframes move and frames along.
struct FramePlace {
  const KeyFrame* reference = nullptr;  // valid as long as the map; none before the first keyframe
  SE3 T_c_reference;

  // As the map now sees it. Needs the map's lock shared.
  SE3 T_cw() const { return reference == nullptr ? SE3{} : T_c_reference * current_pose(*reference); }
  // The same for who keeps it: a proper rotation, however long the chain of products was.
  SE3 T_wc() const;
};

// What a keyframe showed of the objects that are known.
struct KeyframeSightings {
  int frame = 0;
  std::vector<InstanceSighting> sightings;  // with small masks
};

// What was found of objects since the last frame.
struct Findings {
  std::vector<KeyframeSightings> sightings;  // of new keyframes, and of earlier ones of which more is known
  std::vector<TrackedInstance> gone;         // objects that are not followed any more, in their final state
  std::vector<SegmentedFrame> segmented;     // what the segmenter saw in this frame and in earlier ones
};

struct FrameResult {
  int index = 0;
  double timestamp = 0.0;  // seconds
  TrackingReport tracking;
  SE3 T_wc;          // where it was located, or predicted; the map may move it later
  FramePlace place;  // with which it is moved
  bool keyframe = false;
  bool segmented = false;  // shown to the segmenter, or would be if there were one
  int features = 0, stereo_features = 0;
  int movable_features = 0;  // on what is known or taken to move
  StaticPointCount static_points;
  double covered_share = 0.0;  // of the image, by what moves
  double median_depth = 0.0;   // metres, of the features that have one; 0: none has
  double milliseconds = 0.0;   // that it took; 0 where its features were given
  Findings findings;
};

class Slam {
 public:
  // `segmenter` may be empty. `loaded`: a map of an earlier run by the same camera (slam/map/map_file.h), to
  // go on with or to find the way in; the trajectory is then in its world. Throws InputError for a camera
  // that cannot be (fx, fy or baseline not above zero or not finite, an image without pixels), a map with
  // another pyramid, and where there is no map to localise in.
  Slam(const StereoCamera& camera, Sensor sensor, const SlamSettings& settings, Segmenter segmenter = {},
       std::unique_ptr<Map> loaded = {});
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  // For who plays a recording faster than it was taken, before process(): waits for the segmenter as long as
  // a live camera would have given it until the frame of this time, in seconds. So no frame finds less than
  // it would live, however fast the tracker is; a slow network is still late. Does nothing where
  // `semantics.keeps_pace` is off.
  void keep_pace(double timestamp);
  // Takes the next pair, or the next image with its depth, as the sensor has them; grey or colour, of the
  // camera's size (InputError otherwise, and where the first pairs show that left and right are exchanged).
  FrameResult process(const StereoImages& images);
  // The same for a frame whose features were found elsewhere, without the image.
  FrameResult process(int index, double timestamp, const std::shared_ptr<const FrameFeatures>& features) {
    return process(timestamp, features, {index, {}, {}});
  }
  // Takes the place of a frame whose images cannot be had: it is lost, its pose is the predicted one.
  FrameResult process_missing(int index, double timestamp);
  // Waits until the map is complete. What is read before shows the map as far as it is.
  Findings finish();

  Trajectory keyframe_trajectory() const;  // without those of a loaded map
  bool is_loaded(const KeyFrame& keyframe) const { return keyframe.id < first_own_keyframe_; }

  // Loops that were closed so far, in the order in which they were.
  std::vector<ClosedLoop> loops() const;
  // Keyframes that were proven to show earlier places, likewise.
  std::vector<RecognisedPlace> recognised_places() const;
  // The settings with what follows from the sensor and from each other.
  const SlamSettings& settings() const { return settings_; }
  // What the newest frame showed. The thread that calls process() may ask.
  FrameView newest_view() const;
  // After finish() only, the worker's part in them being his until then; but the map may be read before by
  // who holds its mutex shared.
  const Map& map() const { return map_; }
  const PlaceIndex& index() const { return index_; }
  const LoopCloser& loop_closer() const { return loop_closer_; }
  // The objects that are followed, or may be found again.
  std::vector<TrackedInstance> instances() const { return instances_.instances(); }
  const StageTimer& timer() const { return timer_; }

 private:
  SE3 motion_to_depth(const StereoImages& images) const;
  // `image`: with the frame's number, and without pixels where there are none.
  FrameResult process(double timestamp, const std::shared_ptr<const FrameFeatures>& features,
                      const ImageToSegment& image);
  SE3 step_from_last(const SE3& T_cw) const;
  bool find_what_stands(const SE3& T_cw, const FeaturePixels& pixels, std::vector<char>& movable);
  void take_instances();
  void find_what_moves(Frame& frame, const TrackingReport& report);
  bool is_segmented(const FrameResult& frame) const;
  MapWork make_keyframe(Frame& frame, bool starts_submap);

  StereoCamera camera_;  // as the map had it at the last frame
  const SlamSettings settings_;
  StageTimer timer_;
  FeatureMeasurer measurer_;
  const std::unique_ptr<Map> owned_map_;
  Map& map_;
  const int first_own_keyframe_;  // id
  PlaceIndex index_;
  LocalMapper mapper_;
  LoopCloser loop_closer_;
  Tracker tracker_;
  std::size_t frames_ = 0;                                         // so far
  double segmented_time_ = std::numeric_limits<double>::lowest();  // of the last frame that was
  FramePlace last_place_;                                          // of the frame before
  Frame newest_;
  InstanceTracker instances_;
  Movers movers_;
  StaticPoints static_points_;
  const std::array<Dynamics*, 3> dynamics_ = {&instances_, &movers_, &static_points_};  // in their order
  SecondLook second_look_;  // empty where nothing is given back
  Findings findings_;       // since the last frame
  // The last: their threads use the others.
  MapWorker worker_;
  SegmentationWorker segmentation_;
};

}  // namespace penumbra::slam
