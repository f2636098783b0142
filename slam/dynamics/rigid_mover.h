// Tells the world from a rigid thing that moves and fills much of the view, by geometry alone.
//
// The pose with the most inliers is that of the world only where the world has the most features: behind a
// lorry it is the lorry's. So the pairs that disagree with it are asked for a second rigid motion (P3P in
// RANSAC). Of two motions, with A and B the points that only the one or the other explains,
//
//   the one whose points fit into a vehicle (80 % of them within width x height x length) is the mover's, if
//   those of the other do not: the world reaches to both sides and far ahead;
//   if both fit, the one that the motion so far did not lead to expect is;
//   if neither fits, nothing moves: mismatches and bad stereo depth.
//
// A mover is a solid thing: its outline, the hull of the greatest cluster of its pixels, must hold few points
// of the world. Cost: nothing where a tenth of the pairs or less disagrees, else about 2 ms.
// Source of the idea, several rigid motions by RANSAC on what is left over: Torr, Geometric motion
// segmentation and model selection (1998).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slam/dynamics/instance.h"
#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/pose_optimizer.h"

namespace penumbra::slam {

struct RigidMoverSettings {
  bool enabled = true;
  int fewest_points = 25;      // that only the second motion explains ...
  double least_share = 0.1;    // ... of all pairs
  double least_motion = 0.15;  // metres between the two motions
  // What a vehicle's points fit into: metres to the right, down and ahead.
  double width = 4.0, height = 4.5, length = 12.0;
};

struct SeparatedMotions {
  PoseEstimate world;             // as optimize_pose's
  std::optional<Instance> mover;  // without a class; score: share of its outline's points that move with it
  double nearest = 0.0, farthest = 0.0;  // depths of the mover, metres
};

// The pairs of a frame with the last one, while it is being located.
struct PosePairs {
  const StereoCamera& camera;  // as the map has it
  std::span<const PoseObservation> observations;
  const PoseEstimate& dominant;       // the pose with the most inliers
  std::optional<SE3> predicted = {};  // what was expected, if anything was
};

// What they say of the world; where nothing large moves, the dominant pose.
struct WorldPose {
  PoseEstimate estimate;
  std::optional<Instance> mover = {};
};

// `dominant`: the pose with the most inliers; `predicted`: what was expected, if anything was.
SeparatedMotions separate_motions(const StereoCamera& camera, std::span<const PoseObservation> observations,
                                  const PoseEstimate& dominant, const std::optional<SE3>& predicted,
                                  std::uint64_t seed, const RigidMoverSettings& settings);

// Marks in `movable`, per feature, those in the mover's outline whose depth, where they have one, is its own.
void mark_mover(const SeparatedMotions& motions, const FeatureView& features, std::vector<char>& movable);

}  // namespace penumbra::slam
