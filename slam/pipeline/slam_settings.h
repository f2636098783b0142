// Every setting of the pipeline; each group is documented where it is used. How they are read from a file and
// printed: slam/pipeline/settings_file.h.
#pragma once

#include "slam/backend/loop_closer.h"
#include "slam/backend/map_worker.h"
#include "slam/dynamics/instance_tracker_settings.h"
#include "slam/dynamics/rgbd/depth_masks.h"
#include "slam/dynamics/rigid_mover.h"
#include "slam/dynamics/static_points.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/frontend/locating/tracker_settings.h"
#include "slam/pipeline/dense_settings.h"
#include "slam/place/place_index.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Which frames are segmented. `keyframes` (and frames that cannot be located, and one after
// `longest_gap_seconds` without any) and `interval`: beside the tracker, which gets the instances when they
// are there. `all`: every frame, before it is located; the tracker waits.
enum class SegmentationMode { off, keyframes, interval, all };

struct SemanticsSettings {
  SegmentationMode mode = SegmentationMode::keyframes;
  int interval = 1;                   // frames, of SegmentationMode::interval
  double longest_gap_seconds = 0.15;  // of SegmentationMode::keyframes: people go on where the camera stands
  bool keeps_pace = true;             // recordings wait for masks as live cameras do (Slam::keep_pace)
  // Of the network beside the tracker; 0: all but one of `SlamSettings::threads`. With as many as there are
  // processors its threads would wait for each other whenever the tracker holds one of them.
  int threads = 0;
  InstanceTrackerSettings instances;
  RigidMoverSettings rigid_mover;
  StaticPointSettings static_points;
  // How the segmenter that Slam is given makes masks of boxes; for who makes it.
  DepthMaskSettings depth_masks;
};

struct SlamSettings {
  OrbSettings orb;
  TrackerSettings tracker;
  LocalMapperSettings mapper;
  PlaceIndexSettings index;
  LoopCloserSettings loops;
  SemanticsSettings semantics;
  FullBundleSettings full_bundle;
  DenseSettings dense;  // of who makes a dense map (dense_mapper.h)
  // Depth that was taken at another time than the colours is looked up where the camera's motion puts it.
  bool moves_depth = true;
  bool localise = false;  // only find the way in a map that was loaded, which stays as it is
  int threads = 2;        // 1: the right image's features wait for the left's
  bool deterministic = true;
};

// With what follows from the sensor, the camera and other settings, for every caller.
SlamSettings with_derived(SlamSettings settings, Sensor sensor, const StereoCamera& camera);

}  // namespace penumbra::slam
