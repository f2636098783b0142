// The part of the map that a frame is likely to see.
//
// Every keyframe gets a vote for each of the frame's points that it sees. In the local map are the keyframes
// with votes, most votes first, then the covisible ones of the first; and all points that they see. Source:
// Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section V-D.
#pragma once

#include <span>
#include <vector>

#include "slam/map/keyframe.h"

namespace penumbra::slam {

struct LocalMap {
  KeyFrame* reference = nullptr;  // the keyframe with the most votes; the old one where there are no votes
  std::vector<MapPoint*> points;  // in the order of their ids
};

// `shown`: the points that the frame shows, per feature, or nullptr.
LocalMap collect_local_map(std::span<MapPoint* const> shown, KeyFrame* old_reference, int most_keyframes);

}  // namespace penumbra::slam
