// The map: keyframes, points, who sees what, and the covisibility graph. Owns them all; every change of the
// structure goes through here, so that both directions (point -> keyframes, keyframe -> points) always agree.
//
// Erased points stay in memory for a while: whoever holds a pointer to one can still see that it is erased
// and what replaced it. They are freed by the second collect_erased() after readers_let_go() was called.
//
// One thread changes the map, holding mutex() alone; others read, holding it shared. The functions themselves
// do not lock.
#pragma once

#include <atomic>
#include <memory>
#include <shared_mutex>
#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/keyframe.h"
#include "slam/map/map_point.h"

namespace penumbra::slam {

class Map {
 public:
  // `camera`: whose keyframes it will hold; `scales`: level_scales of the pyramid.
  Map(const StereoCamera& camera, std::vector<double> scales) : camera_(camera), scales_(std::move(scales)) {}
  Map(const Map&) = delete;
  Map& operator=(const Map&) = delete;

  // The camera as the map knows it: its disparity offset may be adjusted along with keyframes and points.
  const StereoCamera& camera() const { return camera_; }
  void set_disparity_offset(double pixels) { camera_.disparity_offset = pixels; }

  // Pixel sizes of the pyramid's levels.
  const std::vector<double>& scales() const { return scales_; }

  // In the order they were made, without the erased ones.
  const std::vector<KeyFrame*>& keyframes() const { return active_keyframes_; }
  const std::vector<std::unique_ptr<MapPoint>>& points() const { return points_; }

  // What the next keyframe and the next point will be numbered.
  int next_keyframe_id() const { return next_keyframe_id_; }
  int next_point_id() const { return next_point_id_; }
  // Beyond those of all objects that keyframes show.
  int next_object_number() const;

  // A keyframe that is no part of the map yet; numbered in the order of the calls, which one thread makes,
  // with or without the lock.
  std::unique_ptr<KeyFrame> new_keyframe(int frame_index, double timestamp, const SE3& T_cw,
                                         std::shared_ptr<const FrameFeatures> features);
  // In the order in which they were made.
  KeyFrame* insert_keyframe(std::unique_ptr<KeyFrame> keyframe);
  // Both in one.
  KeyFrame* add_keyframe(int frame_index, double timestamp, const SE3& T_cw,
                         std::shared_ptr<const FrameFeatures> features) {
    return insert_keyframe(new_keyframe(frame_index, timestamp, T_cw, std::move(features)));
  }
  // A new point that `feature` of `keyframe` shows: by definition where it shows it.
  MapPoint* add_point(const Eigen::Vector3d& position, KeyFrame* keyframe, int feature);

  // Nothing happens where the keyframe already sees the point or the feature already shows another one.
  // `aligned`: see KeyFrame.
  void add_observation(MapPoint* point, KeyFrame* keyframe, int feature, bool aligned = false);
  // Erases the point, too, where fewer than two observations are left, unless the last has stereo depth.
  void remove_observation(MapPoint* point, KeyFrame* keyframe);
  void erase_point(MapPoint* point);
  // All that `from` was is now part of `into`.
  void merge_points(MapPoint* from, MapPoint* into);
  // The first keyframe is never erased: it holds the world's origin.
  void erase_keyframe(KeyFrame* keyframe);

  // Number of a new sub-map (slam/map/keyframe.h); the first is 0.
  int begin_submap() { return ++newest_submap_; }

  // Recomputes a point's descriptor, normal and reference distance after its observations changed.
  void update_point(MapPoint* point) const;
  // The same without the descriptor: where only its position or its keyframes' poses have changed.
  void update_view(MapPoint* point) const;
  // Recomputes a keyframe's edges, on both ends.
  void update_covisibility(KeyFrame* keyframe);

  // Takes erased points out of points(), and frees those that an earlier call took out if readers_let_go()
  // was called since.
  void collect_erased();
  // The reader holds no pointers to points that were erased before this call. Needs the lock shared.
  void readers_let_go() const { readers_let_go_ = true; }

  std::shared_mutex& mutex() const { return mutex_; }

 private:
  StereoCamera camera_;
  std::vector<double> scales_;
  std::vector<std::unique_ptr<KeyFrame>> keyframes_;  // also the erased ones
  std::vector<KeyFrame*> active_keyframes_;
  std::vector<std::unique_ptr<MapPoint>> points_;
  std::vector<std::unique_ptr<MapPoint>> erased_points_;  // perhaps still known to a reader
  int next_keyframe_id_ = 0;
  int next_point_id_ = 0;
  int newest_submap_ = 0;
  mutable std::atomic<bool> readers_let_go_{true};
  mutable std::shared_mutex mutex_;
};

// Index of `keyframe`'s feature that shows `point`; -1 where none does.
int observing_feature(const MapPoint& point, const KeyFrame& keyframe);

}  // namespace penumbra::slam
