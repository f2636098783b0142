// Camera pose from 3-D to 2-D pairs of which many are wrong: P3P inside RANSAC.
//
// Draws three pairs, solves P3P, counts the pairs within their chi-square gate (reprojection_error), keeps
// the pose with the most; stops after  log(1 - confidence) / log(1 - w^3)  draws, w the best share of inliers
// so far. The draws are a function of the seed and the number of the draw: results repeat exactly.
//
// Source: Fischler, Bolles, Random Sample Consensus (1981).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slam/geometry/reprojection.h"

namespace penumbra::slam {

// A point of the world and where it was measured.
struct PoseObservation {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // metres
  PixelMeasurement measurement;
};

struct PnpRansacSettings {
  int most_draws = 500;
  int fewest_inliers = 12;
  double confidence = 0.999;
  std::uint64_t seed = 1;
};

struct PnpResult {
  SE3 T_cw;
  std::vector<char> inlier;  // per observation
  int inliers = 0;
};

// Nothing where no pose has `fewest_inliers`.
std::optional<PnpResult> solve_pnp_ransac(const StereoCamera& camera,
                                          std::span<const PoseObservation> observations,
                                          const PnpRansacSettings& settings);

}  // namespace penumbra::slam
