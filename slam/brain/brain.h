// The brain-inspired SLAM: self-motion and images go in, a cognitive map comes out.
//
//   self-motion -> head direction -> grid cells -> place: where the robot believes to be slam/brain/position
//   keyframe?   far or turned enough, and sharp; else the frame before takes its place       (11, 12)
//   view        landmarks with their interest, or an intensity profile                       (13-17)
//   familiar?   templates like the view x the tie to their places (10) x how near the places are
//                 -> proven by geometry and by the keyframe before -> the place cells are pulled there
//   new?        a node where the position has moved on or the scene is new                   (18-20)
//   loop        a link, and the map relaxes                                                  (21, 22)
//
// The robot is always at some place against a node, its anchor: the last one that was made or recalled. What
// is found of a frame is returned against the anchor and not kept; a pose in the world is
// map().node(anchor).pose * since_anchor, at any later time.
//
// Three guards keep what looks alike apart. A place is believed only where the robot can be, given how far it
// drove since it last knew where it was; not if another place far from it explains the image nearly as well;
// and not if the image proves one of the last places as well, which the robot has left: then houses or lamps
// repeat.
//
// Cost of a frame that is no keyframe: microseconds. Of a keyframe at 620 x 188: the landmark finder, 3 ms
// for features, 1 ms for each place that is tried.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "nn/base/stage_timer.h"
#include "slam/brain/brain_settings.h"
#include "slam/brain/map/map_file.h"
#include "slam/brain/motion/calibration.h"
#include "slam/brain/motion/odometry_check.h"
#include "slam/brain/position/position_model.h"
#include "slam/frontend/features/sharpness.h"
#include "slam/pipeline/feature_measurer.h"

namespace penumbra::slam::brain {

// Finds the landmarks of a frame's left image; not needed for intensity templates.
using LandmarkFinder = std::function<void(const StereoImages&, Landmarks&)>;

// A place that was known again.
struct Recall {
  int node = 0;
  bool loaded = false;               // the node is of the map that the run began with
  int frame = 0, earlier_frame = 0;  // the keyframe, and the one of the node
  double similarity = 0.0;
  int inliers = 0;          // 0: not proven by geometry
  double correction = 0.0;  // metres by which the belief was off
};

struct BrainResult {
  int frame = 0;
  double timestamp = 0.0;
  int anchor = 0;          // node
  PlanePose since_anchor;  // pose in its frame
  bool keyframe = false;
  bool blurred = false;  // it was to be one, and the frame before took its place
  std::optional<Recall> recall;
  std::optional<Recall> confirmed;  // of the keyframe before, which this one has confirmed
  // The most similar template of a place that the robot had left, whatever came of it; -1: none.
  int most_similar = -1;
  double similarity = 0.0;
  double map_moved = 0.0;  // metres, the largest move of a node by relaxation
};

class Brain {
 public:
  // `loaded`: the map of an earlier run, to find the way in and to go on with; poses are then in its world
  // once a place of it was recalled. Throws UsageError for settings that make no sense, InputError for a map
  // that does not fit (loaded_map.h).
  Brain(const StereoCamera& camera, Sensor sensor, const BrainSettings& settings, LandmarkFinder finder,
        const StoredMap* loaded = nullptr);

  // `motions`: since the frame before. Throws InputError for images of another size than the camera's.
  BrainResult process(StereoImages images, std::span<const SelfMotion> motions);
  // The same for a frame whose images cannot be had: the robot has moved all the same.
  BrainResult process_missing(int frame, double timestamp, std::span<const SelfMotion> motions);

  const CognitiveMap& map() const { return map_; }
  const TemplateMemory& memory() const { return memory_; }
  const StereoCamera& camera() const { return camera_; }
  const CameraMount& mount() const { return settings_.mount; }
  // Nodes of the map that it began with, and whether one of them was recalled since: poses are in that map's
  // world. True where it began with none.
  int loaded_nodes() const { return loaded_nodes_; }
  bool is_located() const { return located_; }
  // What is probably wrong with the odometry, and whether the relaxation has failed, for people; empty:
  // nothing.
  std::string odometry_doubt() const { return odometry_check_.doubt(); }
  int maps_that_flew_apart() const { return flown_apart_; }
  // Approximately, of map and templates.
  std::size_t bytes() const { return map_.bytes() + memory_.bytes(); }
  // The map as it goes to disk.
  StoredMap stored() const;
  // Lets the map settle a last time.
  void finish() { settle(); }
  StageTimer& timer() { return timer_; }

 private:
  struct Look {  // what a keyframe showed
    int frame = 0;
    double timestamp = 0.0;
    PlanePose since_anchor;
    Template view;
    std::shared_ptr<const FrameFeatures> features;  // where places are proven by geometry
    std::vector<PlacePoint> points;
    bool by_sight = false;      // since_anchor was seen, not felt
    PlanePose felt;             // uncorrected, since the keyframe before ...
    double seconds_felt = 0.0;  // ... and for how long
  };
  struct Candidate {
    int node = 0;
    double similarity = 0.0, activity = 0.0;
    ProvenPlace proven;
  };

  void feel(std::span<const SelfMotion> motions);
  bool is_keyframe_due() const;
  bool is_blurred(const StereoImages& images);
  void take_keyframe(const StereoImages& images, BrainResult& result);
  Look look_at(const StereoImages& images, const PlanePose& since_anchor);
  void see_step(Look& look);

  std::optional<Candidate> recognise(const Look& look, BrainResult& result);
  std::optional<Candidate> nearby(const Look& look);
  std::vector<Candidate> familiar(const Look& look, BrainResult& result);
  std::optional<ProvenPlace> prove(const Look& look, const std::vector<PlacePoint>& points) const;
  std::optional<Candidate> prove(const Look& look, std::vector<Candidate> candidates);
  bool repeats_itself(const Look& look);
  bool agrees_with_the_last(const std::optional<Candidate>& candidate);

  Recall recall_of(const Look& look, const Candidate& candidate) const;
  void recall(const Look& look, const Candidate& candidate, BrainResult& result);
  void join_loaded_map(const PlanePose& here, const PlanePose& there);
  bool is_linked(int node, int other) const;
  bool has_moved_on(const Look& look);
  void make_node(Look look);
  double settle();
  void pull_position();
  int left_nodes() const;

  PlanePose believed(const PlanePose& since_anchor) const { return map_.node(anchor_).pose * since_anchor; }
  double keyframe_distance() const;
  double drift() const;

  const StereoCamera camera_;
  const BrainSettings settings_;
  const LandmarkFinder finder_;
  FeatureMeasurer measurer_;
  std::vector<double> scales_;
  SharpnessTest sharpness_;
  StageTimer timer_;

  PositionModel position_;
  CognitiveMap map_;
  TemplateMemory memory_;
  std::vector<double> way_of_;  // per node: metres driven when it was made
  int loaded_nodes_ = 0;
  bool located_ = true;  // in the map that was loaded
  int anchor_ = -1;
  PlanePose since_anchor_, since_keyframe_;
  OdometryCalibration calibration_;
  OdometryCheck odometry_check_;
  int flown_apart_ = 0;         // relaxations that were given up
  PlanePose felt_, last_felt_;  // uncorrected, since the last keyframe: to this frame, to the one before
  double seconds_felt_ = 0.0, last_seconds_felt_ = 0.0;
  PlanePose keyframe_;                   // the last one, in the anchor's frame
  std::vector<PlacePoint> last_points_;  // of the last keyframe
  int keyframe_frame_ = -1;              // its frame
  std::optional<Recall> unconfirmed_;
  double way_ = 0.0, way_at_fix_ = 0.0;
  double doubt_ = 0.0;           // metres that the robot may be off since it was last known where it is
  double scene_distance_ = 0.0;  // metres, median
  bool on_known_ground_ = false;
  int last_candidate_ = -1, in_a_row_ = 0;
  StereoImages last_;  // the frame before, for a blurred keyframe
  PlanePose last_since_anchor_;
  std::vector<TemplateMatch> matches_;
};

}  // namespace penumbra::slam::brain
