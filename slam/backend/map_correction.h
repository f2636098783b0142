// Moves a map so that a keyframe stands where a loop says it does.
//
//   1. the keyframe and its neighbours, and the points they see, are moved to the place
//   2. points of both visits that are the same are fused; the neighbours of both visits become covisible
//   3. pose graph: motions between neighbours as they were before the loop, loop edges as they are now
//   4. every keyframe takes its new pose, every point moves along with a keyframe that sees it
//
// An edge's information is that of n shared points at a typical distance d, seen with a pixel of error:
// n diag(1, 1, 1, d^2, d^2, d^2), up to a factor that all edges share.
//
// A place in another sub-map moves the younger sub-map as a whole onto the older one instead of 3.
// Source: Strasdat, Davison, Montiel, Konolige, Double Window Optimisation (ICCV 2011); Mur-Artal, Tardos,
// ORB-SLAM2 (T-RO 2017), section III-D.
#pragma once

#include <vector>

#include "slam/backend/pose_graph.h"
#include "slam/map/map.h"
#include "slam/place/place_verifier.h"

namespace penumbra::slam {

struct MapCorrectionSettings {
  int strong_edge = 40;        // shared points that make an edge of the pose graph
  int neighbours = 20;         // covisible keyframes of the old place whose points are fused
  float fusion_radius = 4.0F;  // pixels at level 0
  PoseGraphSettings pose_graph;
};

// A loop that earlier corrections have found; it stays in every later pose graph.
struct LoopEdge {
  KeyFrame* a = nullptr;
  KeyFrame* b = nullptr;
  int inliers = 0;
};

struct MapCorrection {
  bool merged_submaps = false;
  int fused = 0;  // points found again in the other visit's keyframes
  LeastSquaresSummary pose_graph;
};

// `place`: where the keyframe was recognised. `earlier_loops` may hold erased keyframes; they are skipped.
MapCorrection correct_map(Map& map, KeyFrame* keyframe, const VerifiedPlace& place,
                          const std::vector<LoopEdge>& earlier_loops, const MapCorrectionSettings& settings);

}  // namespace penumbra::slam
