// The settings of the tracker and of the ways to locate a frame.
#pragma once

#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/locating/keyframe_choice.h"
#include "slam/frontend/locating/rim_odometry.h"
#include "slam/place/recognition.h"

namespace penumbra::slam {

struct TrackerSettings {
  MismatchFilterSettings mismatch_filter;
  double occluded_share = 0.3;       // of the image, covered by what moves, for a lost frame to be `occluded`
  float search_radius = 10.0F;       // pixels at level 0, around a projection with a known motion
  float wide_search_radius = 30.0F;  // the same when that finds too little
  float map_search_radius = 4.0F;    // around a projection with the frame's own pose
  int fewest_initial_points = 50;    // stereo points that the first frame needs
  int fewest_frame_inliers = 20;     // of the match to the last frame
  double clear_share = 0.4;          // of the last frame's inliers: with fewer, another pose is tried, too
  int fewest_map_inliers = 20;       // of the match to the local map ...
  int fewest_step_inliers = 50;      // ... or, where the map has too few, of the match to the last frame
  int fewest_occluded_inliers = 8;   // of any, where what moves covers `occluded_share` of the view
  double largest_surprise = 0.4;     // metres between prediction and pose, where the view is covered
  int local_keyframes = 20;          // whose points make the local map
  RecognitionSettings recognition;   // of a lost frame
  int lost_before_restart = 5;       // lost frames with enough points after which a new sub-map begins
  int occluded_before_restart = 1;   // the same for occluded ones
  int steps_before_restart = 2;      // frames in a row, each found from the one before it, that it needs
  int fewest_covered_points = 20;    // stereo points that such a frame needs
  KeyframeSettings keyframes;        // which frames become one
  // How much the motion may change from frame to frame: what it is worth where the view is covered.
  double motion_change_metres = 0.1, motion_change_radians = 0.02;
  RimSettings rim;
  bool extends_map = true;  // false: the map stays as it is, the camera is only located in it
  // A frame below this share of the usual sharpness (slam/frontend/features/sharpness.h) leaves it to one of
  // the next frames to become the keyframe; 0: no blur test.
  double least_sharpness = 0.0;
  int longest_sharpness_wait = 3;  // frames
};

}  // namespace penumbra::slam
