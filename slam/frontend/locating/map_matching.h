// The points of the map that a frame shows, and what its features measure of them.
//
//   match_map_points    -> features that look like the points, where these project
//   refine_observations -> each moved to where its point's patch is found, to a tenth of a pixel
//   optimize_pose          (pose_optimizer.h)
//   keep_agreeing       -> the points that agree with the pose
//
// All of it works on Frame::points, per feature the map point that it shows; `scales`: level_scales of the
// pyramid. Cost: about a microsecond a point that is looked for, 3 a feature that is moved.
#pragma once

#include <span>
#include <vector>

#include "slam/frontend/locating/frame.h"
#include "slam/geometry/pose_optimizer.h"

namespace penumbra::slam {

// Looks for those of `points` that the frame does not show yet, `radius` pixels (of level 0) around where
// they project. Returns all that it should show, those it shows included.
std::vector<MapPoint*> match_map_points(const StereoCamera& camera, const std::vector<double>& scales,
                                        const std::vector<MapPoint*>& points, float radius, Frame& frame);

// First what is measured of map points, in the order of the features, then of `loose` ones whose features
// show no map point. Far points hold the rotation, also those that are in no map yet.
std::vector<PoseObservation> refine_observations(const StereoCamera& camera,
                                                 const std::vector<double>& scales,
                                                 std::span<const LoosePoint> loose, Frame& frame);

// Lets go of the points that do not agree with the pose; returns how many stay. An aligned feature that
// misses its narrow gate may still show the point as well as a corner does.
int keep_agreeing(const StereoCamera& camera, const std::vector<double>& scales,
                  std::span<const PoseObservation> observations, const PoseEstimate& estimate, Frame& frame);

}  // namespace penumbra::slam
