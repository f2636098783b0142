// Takes keyframes from the tracker and keeps the map around them good.
//
//   insert:   connect the keyframe to the points it was tracked with -> new points from its stereo depth
//   process:  remove points that proved bad -> triangulate new ones -> fuse duplicates with the neighbours
//             -> local bundle adjustment -> remove redundant keyframes
//
// insert() is quick (2 ms), and all that the next frame needs; process() takes ten times as long and may run
// in another thread, keyframe after keyframe, while more are inserted (slam/backend/map_worker.h). Source:
// Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section VI.
#pragma once

#include <atomic>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/backend/keyframe_culling.h"
#include "slam/backend/local_bundle_adjustment.h"
#include "slam/backend/point_creation.h"
#include "slam/map/map.h"

namespace penumbra::slam {

struct LocalMapperSettings {
  PointCreationSettings point_creation;
  LocalBundleSettings bundle;
  int fuse_neighbours = 5;          // keyframes whose points are compared with the new one's
  double least_found_ratio = 0.25;  // a recent point found in fewer of the frames that should see it goes
  KeyframeCullingSettings culling;
};

class LocalMapper {
 public:
  LocalMapper(Map& map, const LocalMapperSettings& settings)
      : map_(map), settings_(settings), first_unproven_(map.next_point_id()) {}

  // `keyframe` is of the map; `tracked`: per feature the point that the tracker found there, or nullptr;
  // `aligned`: 1 where it found the point's patch, too. Needs the map's lock alone.
  void insert(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked, const std::vector<char>& aligned);

  // To be called for every keyframe in the order of their insertion; locks the map while it changes it.
  // `hurry`, where there is one, is set by somebody else when other keyframes wait: then the bundle
  // adjustment ends with the iteration that it is in. `timer` measures the stages.
  void process(KeyFrame* keyframe, const std::atomic<bool>* hurry, StageTimer& timer);
  void process(KeyFrame* keyframe) {
    StageTimer timer;
    process(keyframe, nullptr, timer);
  }

 private:
  void connect(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked, const std::vector<char>& aligned);
  void renew_patches(KeyFrame* keyframe);
  void give_patches(KeyFrame* keyframe);
  void cull_recent_points(const KeyFrame& newest);
  void fuse_with_neighbours(KeyFrame* keyframe);
  void cull_keyframes(const KeyFrame& newest);

  Map& map_;
  const LocalMapperSettings settings_;
  int first_unproven_;  // id of the oldest point that is still on probation; all of a loaded map are proven
};

}  // namespace penumbra::slam
