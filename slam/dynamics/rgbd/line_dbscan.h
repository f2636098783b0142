// DBSCAN of numbers: density-based clusters on a line.
//
//   N(i)     = { j : |x_j - x_i| <= eps },  i itself among them
//   core     i with |N(i)| >= fewest
//   cluster  core numbers linked by steps of at most eps from one to the next, and all within eps of one
//   noise    the rest
//
// A number that is no core and lies within eps of two clusters belongs to the one with the smaller numbers,
// as in the algorithm in n^2 steps that goes through them in ascending order: the clusters are the same.
// Depth has one dimension, so once the numbers are sorted each N(i) is one piece of them, whose ends only
// move up. Cost: O(n), about 5 ns a number; sorting comes before, O(n log n). Source: Ester, Kriegel, Sander,
// Xu, A density-based algorithm for discovering clusters (KDD 1996).
#pragma once

#include <span>
#include <vector>

namespace penumbra::slam {

inline constexpr int kNoise = -1;

// `x`: ascending, finite; eps >= 0, fewest >= 1. cluster[i]: of x[i], from 0 in the order of the numbers, or
// kNoise. Returns how many there are.
int line_dbscan(std::span<const float> x, float eps, int fewest, std::vector<int>& cluster);

// Distance of each of `x` (ascending) to the k-th nearest of the others, k from 1 to n - 1. O(n).
void nearest_distances(std::span<const float> x, int k, std::vector<float>& distance);

// Where an ascending curve turns up: the value of the point that lies farthest below the straight line from
// the first point to the last; 0 for an empty one. Source: Satopaa et al., Finding a "kneedle" in a haystack
// (2011).
float knee_of(std::span<const float> curve);

}  // namespace penumbra::slam
