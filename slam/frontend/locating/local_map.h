// The part of the map that a frame is likely to see.
//
// Every keyframe gets a vote for each of the frame's points that it sees. In the local map are the keyframes
// with votes, most votes first, then the covisible ones of the first; and all points that they see. Source:
// Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section V-D.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slam/map/keyframe_table.h"

namespace penumbra::slam {

struct LocalMap {
  KeyFrame* reference = nullptr;  // the keyframe with the most votes; the old one where there are no votes
  std::vector<MapPoint*> points;  // in the order of their ids
};

// Collects one local map after the other; keeps its memory: 16 bytes for each keyframe, and 4 for each point,
// that the map has ever had.
class LocalMapCollector {
 public:
  // `shown`: the points that the frame shows, per feature, or nullptr. Valid until the next call.
  const LocalMap& collect(std::span<MapPoint* const> shown, KeyFrame* old_reference, int most_keyframes);

 private:
  void choose_keyframes(std::span<MapPoint* const> shown, std::size_t most);
  void collect_points();

  struct NumberedPoint {
    int id;
    MapPoint* point;
  };
  LocalMap local_;
  KeyframeTable votes_;
  std::vector<KeyFrame*> keyframes_;
  std::vector<std::uint32_t> seen_in_;  // by the points' ids: the collection that has the point
  std::uint32_t collection_ = 0;
  std::vector<NumberedPoint> points_;
};

}  // namespace penumbra::slam
