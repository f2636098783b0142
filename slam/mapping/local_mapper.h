// Takes keyframes from the tracker and keeps the map around them good.
//
//   connect the keyframe to the points it was tracked with -> remove points that proved bad -> new points
//   (stereo, triangulation) -> fuse duplicates with the neighbours -> local bundle adjustment -> remove
//   redundant keyframes
//
// It runs in line with the tracker now. process() needs nothing but the keyframe and the map, so it can move
// to a thread of its own behind a queue. Source: Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section
// VI.
#pragma once

#include <vector>

#include "slam/map/map.h"
#include "slam/mapping/local_bundle_adjustment.h"
#include "slam/mapping/point_creation.h"

namespace penumbra::slam {

struct LocalMapperSettings {
  PointCreationSettings point_creation;
  LocalBundleSettings bundle;
  int fuse_neighbours = 5;          // keyframes whose points are compared with the new one's
  double least_found_ratio = 0.25;  // a recent point found in fewer of the frames that should see it goes
  double redundant_share = 0.9;  // a keyframe goes if this share of its close points is seen in three others
};

class LocalMapper {
 public:
  LocalMapper(const StereoCamera& camera, Map& map, const LocalMapperSettings& settings)
      : camera_(camera), map_(map), settings_(settings), first_unproven_(map.next_point_id()) {}

  // `tracked`: per feature the point that the tracker found there, or nullptr; `aligned`: 1 where it found
  // the point's patch, too.
  void process(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked, const std::vector<char>& aligned);

 private:
  void connect(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked, const std::vector<char>& aligned);
  void renew_patches(KeyFrame* keyframe);
  void cull_recent_points(const KeyFrame& newest);
  void fuse_with_neighbours(KeyFrame* keyframe);
  void cull_keyframes(const KeyFrame& newest);
  bool is_redundant(const KeyFrame& keyframe) const;

  const StereoCamera camera_;
  Map& map_;
  const LocalMapperSettings settings_;
  int first_unproven_;  // id of the oldest point that is still on probation; all of a loaded map are proven
};

}  // namespace penumbra::slam
