#include "slam/pipeline/slam_settings.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

// How many of a keyframe's close points a frame must show not to become one itself (docs/slam/mapping.md).
constexpr double kStereoCloseShare = 0.35, kRgbdCloseShare = 0.25;

}  // namespace

SlamSettings with_derived(SlamSettings settings, Sensor sensor, const StereoCamera& camera) {
  const double close = close_depth(camera, settings.mapper.point_creation);
  settings.tracker.keyframes.close_depth = settings.semantics.instances.close_depth = close;
  KeyframeSettings& keyframes = settings.tracker.keyframes;
  if (keyframes.least_close_share == 0.0)
    keyframes.least_close_share = sensor == Sensor::rgbd ? kRgbdCloseShare : kStereoCloseShare;
  settings.dense = with_derived(settings.dense, sensor, camera);
  settings.tracker.extends_map = !settings.localise;
  // Threads of a bundle adjustment: what is there, less the tracker's where that goes on meanwhile.
  const int threads = std::max(1, settings.deterministic ? settings.threads : settings.threads - 1);
  settings.mapper.bundle.threads = settings.full_bundle.threads = threads;
  // Beside the tracker, with as many threads as processors, those would wait for each other.
  if (settings.semantics.threads == 0) settings.semantics.threads = std::max(1, settings.threads - 1);
  // The right columns of an RGB-D camera follow from its depth: they have no offset of their own.
  if (sensor == Sensor::rgbd) settings.full_bundle.disparity_offset_sigma = 0.0;
  return settings;
}

}  // namespace penumbra::slam
