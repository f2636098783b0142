// How good a dense map is, where the truth is known (`penumbra synth --scene office`).
//
//   error          per voxel of the map its distance to the nearest place of a standing surface that was seen
//   completeness   share of the voxels of standing surfaces, of what the depth sensor measured, that have a
//                  voxel of the map within `near`
//   ghosts         share of the map's voxels that lie within `ghost` of a surface of somebody or something
//                  that moved, at any time of the recording, also while it stood, and farther than 2 `ghost`
//                  from everything that stands. `people`: of those the voxels of people; the rest are chairs
//                  that were pushed, boxes that were carried
//
// The truth is kept as voxels, too; distances are to the mean places in them.
#pragma once

#include <vector>

#include "slam/evaluation/alignment.h"
#include "slam/map/dense/cloud_files.h"
#include "slam/map/dense/dense_view.h"
#include "slam/map/dense/voxel_grid.h"

namespace penumbra::slam {

struct DenseScore {
  double median_error = 0.0, p95_error = 0.0;  // metres
  // Of voxels whose surface was seen from 2.5 to 3.5 m away, on average.
  double median_error_at_3m = 0.0;
  double completeness = 0.0, ghosts = 0.0, people = 0.0;  // shares
  int voxels = 0, truth_voxels = 0;
};

// Where the world of the estimate lies in that of the truth, by positions and orientations: also of a camera
// that hardly moves, whose positions alone leave the turn open.
//
//   R = the rotation nearest to  sum R_truth_i R_estimate_i^T,     t = mean( t_truth_i - R t_estimate_i )
//
// Paired index by index; InputError where there is none.
Similarity align_poses(const Trajectory& truth, const Trajectory& estimate);

class DenseTruth {
 public:
  static constexpr std::uint8_t kStands = 0, kThingMoves = 1, kPerson = 2;

  explicit DenseTruth(double voxel = 0.01) : standing_(voxel), things_(2.0 * voxel), people_(2.0 * voxel) {}

  // A frame with its true depth and what its pixels show, kStands, kThingMoves or kPerson; `sensed` as the
  // camera measured it. All of one size; metres, 0 = none. Beyond `farthest` nothing counts.
  void add(const StereoCamera& camera, const SE3& T_wc, const FloatImage& depth, const ByteImage& kinds,
           const FloatImage& sensed, double farthest);

  // `truth_from_map`: where the map lies in the world of the truth.
  DenseScore score(const DenseCloud& map, const Similarity& truth_from_map) const;

 private:
  VoxelGrid standing_;  // colour[0]: mean distance from which it was seen; class 1: the sensor measured it
  VoxelGrid things_, people_;  // that moved
  std::uint32_t frames_ = 0;
};

}  // namespace penumbra::slam
