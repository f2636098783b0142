// Makes one map of several that recordings of the same camera have left: what shows the same place is tied,
// what shares nothing stays apart.
//
//   append all maps as pieces of their own (sub-maps, slam/map/keyframe.h) and index their keyframes
//   for each keyframe of each map:
//     places of other maps that look alike          (place_index.h), verified by geometry (place_verifier.h)
//       one place alone: neither the other map nor its own shows the same view elsewhere
//     several keyframes agree on where that is?     (place_sightings.h)
//     -> the younger piece moves to the older one as a whole, or, where both are one piece already, the map
//        is corrected as at a loop; points that are the same are fused   (map_correction.h)
//   of each piece that grew: keyframes that the others make redundant go   (keyframe_culling.h)
//     -> what is left is adjusted as a whole        (full_bundle_adjustment.h)
//
// The camera's disparity offset is the mean of the maps', by their keyframes, and not adjusted again: each
// recording has found it by itself, and what the seams of a merged map leave would be taken for it.
//
// Nothing is known beforehand of where maps are relative to each other, so that proof is geometry alone. A
// wrong tie ruins both maps, a missed one costs a chance: settings are those of loops, with one keyframe more
// that must agree.
//
// The maps are taken in an order of their own, the largest first (keyframes, then points, then the time of
// the first keyframe): the result does not depend on the order in which they are given. Memory: that of all
// maps together and one adjustment. Cost: a query a keyframe (1 ms), verification where something is alike,
// and the adjustments.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "slam/backend/full_bundle_adjustment.h"
#include "slam/backend/keyframe_culling.h"
#include "slam/backend/loop_closer.h"
#include "slam/backend/point_creation.h"

namespace penumbra::slam {

struct MapMergerSettings {
  MapMergerSettings() {
    loops.consistent = 4;
    adjustment.disparity_offset_sigma = 0.0;
  }
  LoopCloserSettings loops;
  PointCreationSettings points;  // for what counts as close
  KeyframeCullingSettings culling;
  FullBundleSettings adjustment;
};

// What became of one map.
struct MergedPart {
  std::size_t source = 0;  // which of the maps that were given
  int keyframes = 0;       // of it, when it came
  int piece = 0;           // the sub-map that its first keyframe is part of now
  SE3 T_merged_own;        // from its own world to the merged map's, at its first keyframe
  int ties = 0;            // places of other maps that it was tied by
};

struct MergedMaps {
  std::unique_ptr<Map> map;
  std::vector<MergedPart> parts;  // as the maps were given
  int pieces = 0;                 // that are not tied to each other
};

// Appends the keyframes and points of `from` to `into`, renumbered: ids, sub-maps and objects go on behind
// those of `into`. Both are of one camera. Returns the first of its keyframes; nullptr where it has none.
KeyFrame* append_map(Map& into, const Map& from);

// `progress`: called with the keyframes that were looked at so far, and of how many; may be empty.
MergedMaps merge_maps(const std::vector<std::unique_ptr<Map>>& maps, const MapMergerSettings& settings,
                      const std::function<void(int, int)>& progress = {});

}  // namespace penumbra::slam
