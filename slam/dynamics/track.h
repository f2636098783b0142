// An object over many frames: what is known of it, and the views by which it is followed.
//
// It has one of three states, by geometry: its class only gives the prior probability that it moves
// (motion_belief.h).
#pragma once

#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/instance_view.h"
#include "slam/dynamics/point_origin.h"

namespace penumbra::slam {

enum class MotionState { fixed, still, moving };

// An object: what is known of it over all frames that showed it.
struct TrackedInstance {
  int id = 0;
  std::string class_name;  // empty: found by its motion alone
  double score = 0.0;      // the best of its detections
  int detections = 0;
  int first_frame = 0, last_frame = 0;  // that showed it
  double log_odds = 0.0;                // of moving
  bool can_move = true;
  bool measured = false;  // whether there is evidence beside the prior
  bool part = false;      // its motion is another's, in which it lies: of its own nothing is known yet
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // metres a second, odometry's frame
  Eigen::Vector3d size = Eigen::Vector3d::Zero();      // box around its points as last seen, metres
  double visible_share = 1.0;  // area of its mask, compared with the largest that it had for its depth

  double moving_probability() const { return 1.0 / (1.0 + std::exp(-log_odds)); }
  MotionState state() const {
    return log_odds > 0.0 ? MotionState::moving : can_move ? MotionState::still : MotionState::fixed;
  }
};

// What a frame showed of an object: for pictures and reports.
struct InstanceSighting {
  int id = 0;
  Rect region;
  ByteImage mask;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // camera's frame, metres
  MotionState state = MotionState::still;            // when it was last looked at
  double visible_share = 1.0;
};

// An object that is followed from frame to frame, or may be found again.
struct Track {
  TrackedInstance instance;
  std::deque<InstanceView> views;    // oldest first, of consecutive frames; there is one at least
  std::vector<PointOrigin> origins;  // per feature of the newest view
  int carried = 0, missed = 0;       // since it was last found
  double reference_area = 0.0;       // largest area * depth^2
  bool active = false;               // in view

  bool moves() const { return instance.state() == MotionState::moving; }
  // By evidence of its own, or because its class decides.
  bool is_known_to_move() const { return moves() && instance.measured && !instance.part; }
};

}  // namespace penumbra::slam
