// Gives features back that were left out by their class alone and that stand still: a person who sits, a
// chair that nobody moves.
//
//   before the pose: what is near what can move in space, and so may move with it, a box that somebody
//     carries, a chair that is pushed, is left out as well, where enough else remains
//   first pose, from what is surely the world (tracker.h)
//     -> features that are left out are matched with an earlier view's points, where these would be seen if
//        they stood still
//     -> the dual static-point constraint judges each (dual_constraint.h); neighbours must agree
//     -> those that stand still join; second pose, from the first
//
// The earlier view is the newest located frame that is old enough for a walk to show, a third of a second. A
// feature that finds no match there stands if all around it does; without judged neighbours it stays left
// out: what is not known to stand is taken to move. Poses are odometry's. The frames are those that the
// tracker of instances keeps (instance_tracker.h), whose before_pose() and after_pose() come first. One
// thread uses it; it repeats bit for bit.
//
// Cost: below 1 ms for 500 features on what can move; nothing where there are none.
#pragma once

#include <span>
#include <vector>

#include "slam/dynamics/dual_constraint.h"
#include "slam/dynamics/dynamics.h"
#include "slam/dynamics/frame_history.h"
#include "slam/frontend/features/frame_matcher.h"

namespace penumbra::slam {

struct StaticPointSettings {
  DualConstraintSettings constraint;
  double least_age = 0.3, longest_age = 1.5;  // seconds, of the earlier view
  double reach = 0.4;                         // metres, from what can move to what may move along
  int fewest_others = 200;                    // features with depth that must remain where that is left out
  double search_radius = 10.0;                // pixels at level 0
  double neighbourhood = 40.0;                // pixels
  double like_depth = 0.1;                    // of the depth, by which neighbours may differ
  int fewest_neighbours = 3;                  // judged, the feature among them
  double agreeing_share = 0.6;                // of them that must stand still ...
  double agreeing_share_unmatched = 0.75;     // ... around a feature without a match
};

// How many features were left out, found in the earlier view, and given back for a second pose, which may
// fail.
struct StaticPointCount {
  int left_out = 0, compared = 0, given_back = 0;
};

class StaticPoints : public Dynamics {
 public:
  // `scales`: level_scales of the pyramid. `history` is read while the object lives, and should reach back to
  // StaticPointSettings::least_age.
  StaticPoints(const StereoCamera& camera, std::vector<double> scales, const StaticPointSettings& settings,
               const FrameHistory& history);

  void before_pose(const FrameBeforePose& frame, std::vector<char>& movable) override;
  bool between_poses(const FrameBetweenPoses& frame, std::vector<char>& movable) override;
  std::vector<Instance> after_pose(const FrameAfterPose& /*frame*/, std::vector<char>& /*movable*/) override {
    return {};
  }

  const StaticPointCount& count() const { return count_; }  // of the newest frame

 private:
  enum class Verdict : char { unknown, stands, moves };
  void add_companions(const FeatureView& features, std::vector<char>& movable);
  const FrameRecord* earlier_view() const;
  void find_marked_places(const FeatureView& features);
  bool is_near_marked(const Eigen::Vector2d& pixel) const;
  void judge(const FrameRecord& earlier, const SE3& T_c_k, const FeatureView& now,
             const std::vector<char>& movable);
  bool stands(const FeatureView& features, int feature) const;

  const StereoCamera camera_;
  const std::vector<double> scales_;
  const StaticPointSettings settings_;
  const FrameHistory& history_;
  StaticPointCount count_;
  std::vector<int> front_;               // features whose neighbours are to be left out
  std::vector<char> grown_;              // per feature, as `movable`
  std::vector<Verdict> verdicts_;        // per feature
  std::vector<int> back_;                // features that are given back
  std::vector<char> taken_;              // per feature: not to be matched
  std::vector<char> marked_places_;      // per cell of the image
  std::vector<Projection> projections_;  // of the earlier view's points
};

}  // namespace penumbra::slam
