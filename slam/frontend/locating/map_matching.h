// The points of the map that a frame shows, and what its features measure of them.
//
//   match_map_points    -> features that look like the points, where these project
//   refine_observations -> each looked for where its point's patch is found, to a tenth of a pixel
//   optimize_pose          (pose_optimizer.h)
//   keep_agreeing       -> the points that agree with the pose
//
// All of it works on a hypothesis of where the frame is, above all on its `points`; the frame stays as it is.
// `scales`: level_scales of the pyramid. Cost: about a microsecond a point that is looked for, 3 a feature
// whose patch is.
#pragma once

#include <span>
#include <vector>

#include "slam/frontend/locating/hypothesis.h"
#include "slam/geometry/pose_optimizer.h"

namespace penumbra::slam {

// Looks for those of `points`, which are in the order of their ids, that are not found yet, `radius` pixels
// (of level 0) around where they project. `looked_for` becomes all that the frame should show, what was found
// before included.
void match_map_points(const StereoCamera& camera, const std::vector<double>& scales,
                      const std::vector<MapPoint*>& points, float radius, const Frame& frame,
                      Hypothesis& hypothesis);

// First what is measured of map points, in the order of the features, then of the loose ones whose features
// show no map point. Far points hold the rotation, also those that are in no map yet.
std::vector<PoseObservation> refine_observations(const StereoCamera& camera,
                                                 const std::vector<double>& scales, const Frame& frame,
                                                 Hypothesis& hypothesis);

// Lets go of the points that do not agree with the pose; returns how many stay. An aligned feature that
// misses its narrow gate may still show the point as well as a corner does.
int keep_agreeing(const StereoCamera& camera, const std::vector<double>& scales,
                  std::span<const PoseObservation> observations, const PoseEstimate& estimate,
                  const Frame& frame, Hypothesis& hypothesis);

}  // namespace penumbra::slam
