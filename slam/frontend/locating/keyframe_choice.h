// Which frames become keyframes: those that the map would learn from.
//
//   similarity(frame, K) = points of K that the frame shows / points of K
//
// An image that resembles a keyframe teaches the map nothing; one whose best similarity to the keyframes is
// low becomes a keyframe. Far points stay in view for long and near ones leave it soon, but it is these that
// measure how far the camera goes: a frame that shows few of the close points and has others to offer becomes
// a keyframe, too, and so does the last of a long row of frames that did not. All of it is relative to the
// keyframe, so that it means the same for 500 features as for 2000.
//
// Source: similarity: Jiang, Chen, Yuan, Visual SLAM combining mixed attention instance segmentation (2022);
// close points: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-E.
#pragma once

#include "slam/frontend/locating/frame.h"

namespace penumbra::slam {

struct KeyframeSettings {
  double least_similarity = 0.5;
  double least_close_share = 0.3;  // of the keyframe's close points
  double close_depth = 20.0;       // metres; up to which stereo depth counts as close
  int longest_gap = 20;            // frames
};

// Share of the keyframe's points that the frame shows; 0 where it has none.
double similarity(const Frame& frame, const KeyFrame& keyframe);

// `frame`: one that was located, with the points that it shows; `most_similar`: the keyframe that shares the
// most points with it; `frames_since`: the newest keyframe, 1 for the frame after it.
bool becomes_keyframe(const Frame& frame, const KeyFrame& most_similar, int frames_since,
                      const KeyframeSettings& settings);

}  // namespace penumbra::slam
