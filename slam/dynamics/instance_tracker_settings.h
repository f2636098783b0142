// The settings of the tracker of instances and of what it is made of.
#pragma once

#include "slam/dynamics/companion_finder.h"
#include "slam/dynamics/instance_view.h"
#include "slam/dynamics/object_motion.h"

namespace penumbra::slam {

struct InstanceTrackerSettings {
  InstanceViewSettings view;
  ObjectMotionSettings motion;
  CompanionSettings companions;
  double least_score = 0.5;         // instances below it are ignored
  double known_score_share = 0.6;   // of it, that is enough for what shows an object known to move
  bool check_motion = true;         // false: whatever can move counts as moving, as DynaSLAM's prior has it
  int history = 60;                 // frames that a late result may be about
  int frames_back = 5;              // from which a new object's points are looked up
  double longest_look = 1.0;        // seconds over which displacements are measured
  double least_overlap = 0.3;       // of masks of the same object ...
  double least_containment = 0.6;   // ... or of the smaller one's area, with the same class ...
  double nearest_metres = 1.5;      // ... or how close their places are then, plus 5 % of the depth
  int most_carried = 30;            // frames that a mask is carried without being found again
  int most_missed = 2;              // results that do not show it
  double standing_log_odds = -2.0;  // of moving, below which what can move and was measured stands
  double large_share = 0.15;        // of the image, of what is left out on suspicion where the way is lost
  // Stereo features within `close_depth` metres that must remain where one is left out on suspicion.
  int fewest_others = 50;
  double close_depth = 20.0;
};

}  // namespace penumbra::slam
