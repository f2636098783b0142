// One interface for all that finds out what moves in the scene, whatever it goes by: masks, geometry, depth.
//
//   before the pose    which features are to be left out, by what is known so far
//   between the poses  which of those turn out to stand still, by a first pose without them
//   after the pose     what the frame, now that it is located, shows to move
//   edits to the map   what turns out later to be wrong in its keyframes
//
// The tracker of instances (instance_tracker.h) implements it for masks, Movers (movers.h) for what geometry
// alone tells, StaticPoints (static_points.h) for single points of what is left out. The pipeline calls them
// in a row, in one thread, frame by frame; each adds its marks to those of the ones before it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slam/dynamics/instance.h"
#include "slam/dynamics/keyframe_labels.h"
#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

// A frame that is to be located.
struct FrameBeforePose {
  int index = 0;
  double time = 0.0;                              // seconds
  std::shared_ptr<const FrameFeatures> features;  // as they were measured
  SE3 T_step;                                     // motion that is predicted since the last frame
};

// The same frame, located by what is not left out.
struct FrameBetweenPoses {
  SE3 T_step;                             // motion since the last frame
  const FeaturePixels* pixels = nullptr;  // where its features are
};

// The same frame, located, or given up.
struct FrameAfterPose {
  SE3 T_step;                                   // motion since the last frame
  bool reliable = false;                        // false: nothing is to be learnt about motions from it
  std::shared_ptr<const FeaturePixels> pixels;  // where its features are; null: as measured
  std::optional<Instance> mover;                // that was told from the world by its pose (rigid_mover.h)
};

struct MapEdits {
  std::vector<MovingFeatures> moving;    // to be taken out of the map
  std::vector<KeyframeObjects> objects;  // that keyframes show

  bool empty() const { return moving.empty() && objects.empty(); }
};

class Dynamics {
 public:
  Dynamics() = default;
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;
  virtual ~Dynamics() = default;

  // Begins a frame; marks in `movable`, per feature, what is to be left out.
  virtual void before_pose(const FrameBeforePose& frame, std::vector<char>& movable) = 0;
  // The frame of the last before_pose(). Clears the marks in `movable` of features that stand still: true
  // where there are any, and a second pose is worth while.
  virtual bool between_poses(const FrameBetweenPoses& /*frame*/, std::vector<char>& /*movable*/) {
    return false;
  }
  // The same frame. `movable` has the marks of its pose, and gets more. Returns things
  // that were found to move, for others to follow.
  virtual std::vector<Instance> after_pose(const FrameAfterPose& frame, std::vector<char>& movable) = 0;
  // What is to be told to the map since the last call.
  virtual MapEdits take_edits() { return {}; }
};

}  // namespace penumbra::slam
