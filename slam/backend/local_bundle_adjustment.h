// Bundle adjustment of the map around one keyframe.
//
// Free: the keyframe, its closest covisible keyframes, and all points that they see. Fixed: other keyframes
// that see those points; they hold the window in its place. The map's first keyframe is always fixed. Two
// passes: with the Huber kernel, then without it and without the observations beyond their chi-square gate;
// observations that are beyond it at the end leave the map.
// Source: Mur-Artal, Montiel, Tardos, ORB-SLAM (T-RO 2015), section VI-D.
#pragma once

#include <atomic>
#include <mutex>
#include <shared_mutex>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"

namespace penumbra::slam {

struct LocalBundleSettings {
  int window = 10;            // free keyframes, the new one included
  int border = 20;            // fixed keyframes at most; those that share the most points with the window
  int robust_iterations = 5;  // at most, with the Huber kernel
  int iterations = 5;         // at most, without
  int threads = 1;
};

struct LocalBundleReport {
  int free_keyframes = 0, fixed_keyframes = 0, points = 0, observations = 0, removed_observations = 0;
  bool stopped = false;  // before its end
};

// `lock`, where there is one, holds the map's mutex; it is let go while nothing of the map is touched, which
// is nearly all the time. Others may add keyframes, points and observations meanwhile, but not erase;
// keyframes that were added move along with their neighbours (newcomers.h). It ends after the iteration in
// which `stop` is set, and takes what it has reached; then no observation leaves the map.
LocalBundleReport adjust_local_bundle(KeyFrame* centre, Map& map, const LocalBundleSettings& settings,
                                      std::unique_lock<std::shared_mutex>* lock = nullptr,
                                      const std::atomic<bool>* stop = nullptr);

}  // namespace penumbra::slam
