// What every way to locate a frame starts from. All of it is constant while the frame is located.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/dynamics/rigid_mover.h"
#include "slam/frontend/locating/frame.h"
#include "slam/frontend/locating/last_frame.h"
#include "slam/frontend/locating/tracker_settings.h"
#include "slam/geometry/pose_optimizer.h"
#include "slam/map/map.h"
#include "slam/place/place_index.h"

namespace penumbra::slam {

// Who knows what moves: tells which pose is the world's, and marks in `movable`, where that is given, the
// frame's features on something else.
using WorldPoseFinder = std::function<WorldPose(const PosePairs& pairs, std::vector<char>* movable)>;

struct LocatingInput {
  const Frame& frame;     // to be located
  const LastFrame& last;  // the last one that was
  const Map& map;
  const PlaceIndex& index;
  const TrackerSettings& settings;
  StageTimer& timer;  // measures the stages

  SE3 predicted;  // pose that the motion so far leads to
  bool motion_known = false;
  // What is expected of the pose, where the view is covered.
  std::optional<PosePrior> prior = std::nullopt;
  int last_pairs = 0, last_inliers = 0;        // of the last frame: pairs with the one before, map points
  KeyFrame* reference = nullptr;               // the keyframe that shares the most points with the last frame
  int first_own_keyframe = 0;                  // id; older ones are of a map that was loaded
  const WorldPoseFinder* who_knows = nullptr;  // null: what most pairs agree with is the world

  bool is_covered() const { return frame.covered_share >= settings.occluded_share; }
  // Pairs or map points that a pose needs at least.
  int fewest(int uncovered) const { return is_covered() ? settings.fewest_occluded_inliers : uncovered; }
  WorldPose world_pose(const PosePairs& pairs, std::vector<char>* movable = nullptr) const {
    return who_knows == nullptr ? WorldPose{pairs.dominant} : (*who_knows)(pairs, movable);
  }
  // Whether so many pairs with the last frame, or map points, agree, next to those of the frame before, that
  // no other pose will have more.
  bool is_clear(int inliers, int before) const {
    return inliers > 0 && inliers >= settings.clear_share * before;
  }
};

}  // namespace penumbra::slam
