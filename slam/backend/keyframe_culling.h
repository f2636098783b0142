// Which keyframes a map can do without.
//
// One is redundant if most of its close points are seen in three others at least, at the same scale or a
// finer one: what it knows of them the others know. Far points do not count, for they stay in view for long.
// Where many recordings show one street, their map is thereby smaller than their sum. Cost: O(observations of
// its points). Source: Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section VI-E.
#pragma once

#include "slam/map/map.h"

namespace penumbra::slam {

struct KeyframeCullingSettings {
  double redundant_share = 0.9;  // of its close points
};

// `close_depth`: metres up to which stereo depth counts as close.
bool is_redundant(const KeyFrame& keyframe, double close_depth, const KeyframeCullingSettings& settings);

// Takes the redundant keyframes of a sub-map out of the map, one after the other, the newest first; each is
// judged by those that are left. Its first keyframe stays. Returns how many have gone.
int cull_redundant_keyframes(Map& map, int submap, double close_depth,
                             const KeyframeCullingSettings& settings);

}  // namespace penumbra::slam
