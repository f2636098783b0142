// Which frames become keyframes: those that the map would learn from.
//
//   similarity(frame, K) = points of K that the frame shows / points of K
//
// An image that resembles a keyframe teaches the map nothing; one whose best similarity to the keyframes is
// low becomes a keyframe. Far points stay in view for long and near ones leave it soon, but it is these that
// measure how far the camera goes: a frame that shows few of the close points and has others to offer becomes
// a keyframe, too. So does the first after a while without any on new ground, where the newest keyframe is
// the one that it resembles most: a street that is driven every night, or a block that is driven all day,
// teaches nothing by being driven slowly. All of it is relative to the keyframe or in seconds, so that it
// means the same for 500 features as for 2000, at 10 frames a second as at 30.
//
// More keyframes than these cost time and memory and hardly make the path better (docs/slam/mapping.md).
//
// Source: similarity: Jiang, Chen, Yuan, Visual SLAM combining mixed attention instance segmentation (2022);
// close points: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-E.
#pragma once

#include "slam/frontend/locating/frame.h"

namespace penumbra::slam {

struct KeyframeSettings {
  double least_similarity = 0.35;
  // Share of the keyframe's close points; 0: by the sensor (slam_settings.h). A depth camera measures all
  // that it sees at once, a stereo pair needs more views of what is far.
  double least_close_share = 0.0;
  double close_depth = 20.0;  // metres; up to which stereo depth counts as close
  double longest_gap_seconds = 5.0;
};

// Share of the keyframe's points that the frame shows; 0 where it has none.
double similarity(const Frame& frame, const KeyFrame& keyframe);

// `frame`: one that was located, with the points that it shows; `most_similar`: the keyframe that shares the
// most points with it; `seconds_since`: that one, where it is the newest, otherwise 0.
bool becomes_keyframe(const Frame& frame, const KeyFrame& most_similar, double seconds_since,
                      const KeyframeSettings& settings);

}  // namespace penumbra::slam
