// Fundamental matrix of two views from point pairs of which many are wrong: the eight-point algorithm inside
// RANSAC.
//
//   x'^T F x = 0,   x = (u, v, 1) in the first image, x' in the second; rank F = 2, |F| = 1
//
// Each pair gives one linear equation in the nine entries of F; the solution of n >= 8 is the eigenvector of
// A^T A with the smallest eigenvalue, after both images' points were moved and scaled to mean 0 and mean
// distance sqrt(2), and its smallest singular value set to 0. A pair is an inlier where its distance to F,
//
//   d^2 = (x'^T F x)^2 / ((F x)_1^2 + (F x)_2^2 + (F^T x')_1^2 + (F^T x')_2^2)        Sampson's, pixels^2
//
// is below the threshold. The draws are a function of the seed and the number of the draw; they end after
// log(1 - confidence) / log(1 - w^8), w the best share of inliers so far. Then F is solved from all inliers
// again, twice. Where all points lie on one plane, or the camera only turned, F is not unique: distances are
// then too small, never too large. Cost: about 8 us a draw of 300 pairs.
// Source: Hartley, In defense of the eight-point algorithm (PAMI 1997); Torr and Murray, The development and
// comparison of robust methods for estimating the fundamental matrix (IJCV 1997).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace penumbra::slam {

struct PointPair {
  Eigen::Vector2d first, second;  // pixels
};

struct FundamentalSettings {
  double threshold = 1.0;  // pixels
  double confidence = 0.99;
  int most_draws = 300;
  std::uint64_t seed = 1;
};

struct FundamentalResult {
  Eigen::Matrix3d F;
  std::vector<char> inlier;  // per pair
  int inliers = 0;
};

// From all pairs, 8 or more; nothing where they do not determine it (points that coincide).
std::optional<Eigen::Matrix3d> solve_fundamental(std::span<const PointPair> pairs);

// Nothing for fewer than 8 pairs, or where no draw has 8 inliers.
std::optional<FundamentalResult> find_fundamental(std::span<const PointPair> pairs,
                                                  const FundamentalSettings& settings = {});

// Sampson's distance, pixels.
double sampson_distance(const Eigen::Matrix3d& F, const PointPair& pair);
// Of the second point to the line on which the first must be seen, pixels.
double epipolar_distance(const Eigen::Matrix3d& F, const PointPair& pair);

}  // namespace penumbra::slam
